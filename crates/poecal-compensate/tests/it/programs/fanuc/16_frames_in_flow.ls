/PROG  FRAMES_IN_FLOW
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "frames where the order is not plain";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:  UFRAME_NUM=2 ;
   2:  IF R[1]=1,JMP LBL[1] ;
   3:  UFRAME_NUM=R[5] ;
   4:  LBL[1] ;
   5:L P[1] 100mm/sec FINE    ;
   6:  UFRAME_NUM=1 ;
   7:  CALL OTHER    ;
   8:L P[2] 100mm/sec FINE    ;
   9:  UTOOL_NUM=3 ;
  10:  WAIT    .50(sec) ;
  11:  DO[1]=ON ;
  12:L P[3] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    286.298  mm,	Y =    -53.789  mm,	Z =    109.049  mm,
	W =   -177.597 deg,	P =     18.206 deg,	R =    -30.010 deg
};
P[2]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    480.013  mm,	Y =   -306.984  mm,	Z =   -125.623  mm,
	W =   -176.575 deg,	P =     21.681 deg,	R =     49.286 deg
};
P[3]{
   GP1:
	UF : 2, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =    479.852  mm,	Y =   -278.441  mm,	Z =   -126.611  mm,
	W =   -176.317 deg,	P =     21.604 deg,	R =     53.373 deg
};
/END
