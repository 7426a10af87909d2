/PROG  TRACKING
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "a conveyor";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/APPL
  LINE_TRACK;
    LINE_TRACK_SCHEDULE_NUMBER	: 1;
    LINE_TRACK_BOUNDARY_NUMBER	: 1;
/MN
   1:L P[1] 100mm/sec FINE    ;
   2:J P[2] 100% FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    403.789  mm,	Y =     66.298  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     59.990 deg
};
P[2]{
   GP1:
	UF : 0, UT : 1,	
	J1=    18.000 deg,	J2=    20.000 deg,	J3=   -15.000 deg,
	J4=    12.000 deg,	J5=   -70.000 deg,	J6=    40.000 deg
};
/END
