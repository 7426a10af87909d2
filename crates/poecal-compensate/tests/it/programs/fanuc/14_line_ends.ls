/PROG  LINE_ENDS
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "Größe";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:  !Über dem Teil ;
   2:J P[1:über] 100% FINE    ;
   3:L P[2] 100mm/sec FINE    ;
/POS
P[1:über]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    403.789  mm,	Y =     66.298  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     59.990 deg
};
P[2]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X = 398.180424  mm,	Y =  94.303230  mm,	Z = -70.950983  mm,
	W = -177.596642 deg,	P =  18.205785 deg,	R =  63.989977 deg
};
/END
