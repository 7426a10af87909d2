/PROG  NOT_STATED
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "frames that are not stated";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:L P[1] 100mm/sec FINE    ;
   2:L P[2] 100mm/sec FINE    ;
   3:L P[3] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 7,		CONFIG : 'N U T, 0, 0, 0',
	X =    394.909  mm,	Y =    -79.287  mm,	Z =    121.296  mm,
	W =   -174.943 deg,	P =     63.131 deg,	R =    -20.248 deg
};
P[2]{
   GP1:
	UF : 8, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    394.909  mm,	Y =    -79.287  mm,	Z =    121.296  mm,
	W =   -174.943 deg,	P =     63.131 deg,	R =    -20.248 deg
};
P[3]{
   GP1:
	UF : 1, UT : 0,		CONFIG : 'N U T, 0, 0, 0',
	X =    354.979  mm,	Y =    -66.550  mm,	Z =    250.692  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =    -24.010 deg
};
P[4]{
   GP1:
	UF : F, UT : F,		CONFIG : 'N U T, 0, 0, 0',
	X =    394.909  mm,	Y =    -79.287  mm,	Z =    121.296  mm,
	W =   -174.943 deg,	P =     63.131 deg,	R =    -20.248 deg
};
/END
