/PROG  BRANCHES
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "jumps, calls, selections";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:  LBL[1] ;
   2:  SELECT R[1]=1,CALL A ;
    :         =2,JMP LBL[2] ;
    :         ELSE,JMP LBL[1] ;
   3:  FOR R[2]=1 TO 3 ;
   4:L P[1] 100mm/sec CNT100    ;
   5:  ENDFOR ;
   6:  IF R[1]=1 THEN ;
   7:J P[2] 20% FINE    ;
   8:  ELSE ;
   9:J P[3] 20% FINE    ;
  10:  ENDIF ;
  11:  LBL[2:end] ;
  12:L P[1] 2000cm/min FINE Skip,LBL[1]    ;
  13:L P[4] WELD_SPEED CNT100 PTH Wjnt    ;
  14:  END ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 3,		CONFIG : 'N U T, 0, 0, 0',
	X =    117.207  mm,	Y =    -95.865  mm,	Z =    159.260  mm,
	W =   -153.089 deg,	P =    -34.446 deg,	R =     -7.749 deg
};
P[2]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'N U T, 0, 0, 0',
	X =    463.316  mm,	Y =   -534.985  mm,	Z =    -45.078  mm,
	W =   -154.490 deg,	P =    -30.975 deg,	R =     64.042 deg
};
P[3]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'N U T, 0, 0, 0',
	X =    427.220  mm,	Y =   -163.845  mm,	Z =    -20.740  mm,
	W =   -153.089 deg,	P =    -34.446 deg,	R =     74.251 deg
};
P[4]{
   GP1:
	UF : 1, UT : 3,		CONFIG : 'N U T, 0, 0, 0',
	X =     26.522  mm,	Y =    -65.224  mm,	Z =    180.615  mm,
	W =   -156.690 deg,	P =    -34.066 deg,	R =    -17.722 deg
};
/END
