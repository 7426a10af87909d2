/PROG  JOINTS
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "joint positions";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:J P[1:home] 100% FINE    ;
   2:J P[2] 50% CNT100    ;
   3:L P[3] 100mm/sec FINE    ;
/POS
P[1:home]{
   GP1:
	UF : 0, UT : 1,	
	J1=      .000 deg,	J2=      .000 deg,	J3=      .000 deg,
	J4=      .000 deg,	J5=   -90.000 deg,	J6=      .000 deg
};
P[2]{
   GP1:
	UF : 1, UT : 9,	
	J1=  -101.250 deg,	J2=   -30.000 deg,	J3=    12.500 deg,
	J4=      .500 deg,	J5=   -45.000 deg,	J6=   200.000 deg
};
P[3:"above part"]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    407.430  mm,	Y =     37.969  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     55.990 deg
};
/END
