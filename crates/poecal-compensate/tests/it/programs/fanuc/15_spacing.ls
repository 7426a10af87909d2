/PROG  SPACING
/ATTR
OWNER		= MNEDITOR;
COMMENT		= "spacing";
PROG_SIZE	= 1024;
CREATE		= DATE 24-05-17  TIME 10:22:36;
LINE_COUNT	= 12;
PROTECT		= READ_WRITE;
TCD:  STACK_SIZE	= 0,
      TASK_PRIORITY	= 50;
DEFAULT_GROUP	= 1,*,*,*,*;
CONTROL_CODE	= 00000000 00000000;
/MN
   1 :j p[1] 100% fine;
2:L P [ 2 ] 100mm/sec FINE;
   1:L   P[3]   100mm/sec   FINE   ;
/POS
p[1]{gp1: uf:0,ut:1,config:'N U T,0,0,0',
X=403.78874mm,Y=66.29785mm,Z=-70.95098mm,
W=-177.59664deg,P=18.20579deg,R=59.98998deg};
P [ 2 ] { GP1 : 	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',

	X =    398.180  mm,	Y =     94.303  mm,	Z =    -70.951  mm,

	W =   -177.597 deg,	P =     18.206 deg,	R =     63.990 deg } ;
P[ 3 ]
{
GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =   411.1328  mm,	Y =     3.0000  mm,	Z =   -74.1893  mm,
	W =   180.0000 deg,	P =    15.0000 deg,	R =      .0000 deg
};
/END
