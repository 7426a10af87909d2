/PROG  SIMPLE
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "one frame";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:  UFRAME_NUM=0 ;
   2:  UTOOL_NUM=1 ;
   3:J P[1] 100% FINE    ;
   4:L P[2] 250mm/sec CNT50    ;
   5:L P[3] 250mm/sec FINE    ;
   6:J P[1] 100% FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    397.500  mm,	Y =      3.000  mm,	Z =    139.750  mm,
	W =    180.000 deg,	P =       .000 deg,	R =       .000 deg
};
P[2]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    383.720  mm,	Y =    142.126  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     70.990 deg
};
P[3]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    337.150  mm,	Y =   -177.238  mm,	Z =   -180.125  mm,
	W =    149.557 deg,	P =      4.247 deg,	R =   -167.100 deg
};
/END
