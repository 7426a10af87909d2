/PROG  FLIP_AND_ELBOW
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "configurations";
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
   6:L P[6] 100mm/sec FINE    ;
   7:L P[7] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'F U T, 0, 0, 0',
	X =    601.525  mm,	Y =    206.309  mm,	Z =    276.488  mm,
	W =     49.552 deg,	P =    -30.887 deg,	R =    141.239 deg
};
P[2]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    601.525  mm,	Y =    206.309  mm,	Z =    276.488  mm,
	W =     49.552 deg,	P =    -30.887 deg,	R =    141.239 deg
};
P[3]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N D T, 0, 0, 0',
	X =     91.361  mm,	Y =    -27.362  mm,	Z =    351.092  mm,
	W =    -12.398 deg,	P =     -9.016 deg,	R =    152.049 deg
};
P[4]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'F U T, 0, 0, 0',
	X =    403.789  mm,	Y =     66.298  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     59.990 deg
};
P[5]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U, 0, 0, 0',
	X =    403.789  mm,	Y =     66.298  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     59.990 deg
};
P[6]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N L U T, 0, 0, 0',
	X =    403.789  mm,	Y =     66.298  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     59.990 deg
};
P[7]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N D B, 0, 0, 0',
	X =   -127.348  mm,	Y =    -66.129  mm,	Z =    607.660  mm,
	W =     46.865 deg,	P =    -43.442 deg,	R =    123.785 deg
};
/END
