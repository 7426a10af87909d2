/PROG  REGISTERS
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "registers and computed numbers";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:  PR[1]=P[2]    ;
   2:  PR[1,3]=PR[1,3]+50    ;
   3:J PR[1] 100% FINE    ;
   4:L PR[GO[1]:pick] 100mm/sec FINE    ;
   5:  R[1]=1    ;
   6:  LBL[1] ;
   7:L P[R[1]] 100mm/sec FINE    ;
   8:  R[1]=R[1]+1    ;
   9:  IF R[1]<=3,JMP LBL[1] ;
  10:  PR[2]=LPOS    ;
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
/END
