/PROG  OFFSETS
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "offsets and increments";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:L P[1] 100mm/sec FINE Offset,PR[3]    ;
   2:  OFFSET CONDITION PR[3]    ;
   3:L P[2] 100mm/sec FINE Tool_Offset,PR[4:shift]    ;
   4:L P[3] 100mm/sec FINE INC    ;
   5:L P[1] 100mm/sec FINE    ;
   6:C P[4]    
    :   P[5] 100mm/sec FINE Offset,PR[3]    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    399.710  mm,	Y =     65.281  mm,	Z =    -89.581  mm,
	W =   -175.297 deg,	P =     20.276 deg,	R =     60.748 deg
};
P[2]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    398.180  mm,	Y =     94.303  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     63.990 deg
};
P[3]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    386.735  mm,	Y =    120.274  mm,	Z =    -89.581  mm,
	W =   -175.297 deg,	P =     20.276 deg,	R =     68.748 deg
};
P[4]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    381.181  mm,	Y =    148.801  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     71.990 deg
};
P[5]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    366.232  mm,	Y =    172.927  mm,	Z =    -89.581  mm,
	W =   -175.297 deg,	P =     20.276 deg,	R =     76.748 deg
};
/END
