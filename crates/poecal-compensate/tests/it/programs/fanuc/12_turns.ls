/PROG  TURNS
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "turn numbers";
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
   4:L P[4] 100mm/sec FINE    ;
   5:L P[5] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 1',
	X =    411.815  mm,	Y =     48.570  mm,	Z =    -67.921  mm,
	W =    161.661 deg,	P =      -.861 deg,	R =    -40.256 deg
};
P[2]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, -1',
	X =    399.428  mm,	Y =     66.926  mm,	Z =    -70.232  mm,
	W =   -171.356 deg,	P =     16.258 deg,	R =     80.842 deg
};
P[3]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    411.815  mm,	Y =     48.570  mm,	Z =    -67.921  mm,
	W =    161.661 deg,	P =      -.861 deg,	R =    -40.256 deg
};
P[4]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    390.034  mm,	Y =     47.951  mm,	Z =    -63.342  mm,
	W =   -169.827 deg,	P =    -15.363 deg,	R =   -161.771 deg
};
P[5]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 1, 0',
	X =    621.313  mm,	Y =    179.498  mm,	Z =    267.622  mm,
	W =     49.955 deg,	P =     27.305 deg,	R =     87.500 deg
};
/END
