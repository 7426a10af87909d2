/PROG  FRAMES_AND_TOOLS
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "two of each";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1:  UFRAME_NUM=1 ;
   2:  UTOOL_NUM=2 ;
   3:L P[1] 100mm/sec FINE    ;
   4:L P[2] 100mm/sec FINE    ;
   5:  UTOOL_NUM=3 ;
   6:  UFRAME_NUM=2 ;
   7:L P[3] 100mm/sec FINE    ;
   8:L P[4] 100mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    394.909  mm,	Y =    -79.287  mm,	Z =    121.296  mm,
	W =   -174.943 deg,	P =     63.131 deg,	R =    -20.248 deg
};
P[2]{
   GP1:
	UF : 1, UT : 2,		CONFIG : 'N U T, 0, 0, 0',
	X =    466.797  mm,	Y =    -42.392  mm,	Z =    121.296  mm,
	W =   -174.943 deg,	P =     63.131 deg,	R =    -10.248 deg
};
P[3]{
   GP1:
	UF : 2, UT : 3,		CONFIG : 'N U T, 0, 0, 0',
	X =    396.942  mm,	Y =   -523.451  mm,	Z =    -28.665  mm,
	W =   -160.920 deg,	P =     -4.746 deg,	R =    -33.180 deg
};
P[4]{
   GP1:
	UF : 1, UT : 3,		CONFIG : 'N U T, 0, 0, 0',
	X =     79.390  mm,	Y =    -20.401  mm,	Z =    193.923  mm,
	W =   -157.586 deg,	P =     -6.155 deg,	R =   -108.445 deg
};
/END
