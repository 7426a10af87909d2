/PROG  REMARKS
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "remarks; L P[9]";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:  !L P[9] 100mm/sec FINE INC ;
   2:  //L P[1] 100mm/sec FINE INC    ;
   3:  --eg:L P[1] 100mm/sec FINE INC ;
   4:L P[1:don't stop] 100mm/sec FINE ;
   5:  MESSAGE[L P[1] INC] ;
   6:  CALL SUB('P[1]') ;
   7:  IF (!DI[1] AND DI[2]=ON),JMP LBL[1] ;
   8:L P[2] 100mm/sec CNT R[3] ACC50 TB .50sec,DO[1]=ON ;
/POS
P[1:don't stop]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    403.789  mm,	Y =     66.298  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     59.990 deg
};
P[2]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    398.180  mm,	Y =     94.303  mm,	Z =    -70.951  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =     63.990 deg
};
/END
