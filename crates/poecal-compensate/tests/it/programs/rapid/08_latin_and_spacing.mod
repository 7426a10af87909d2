module Wörter(SYSMODULE)
	! Grüße aus München; MoveL p10,v5,fine,tool0;
	Const  ROBTARGET	pÖse := [[1466.557 ,  996.588 ,  1332.771],[0.1170851 ,  -0.3804825 ,  0.9098816 ,  0.1167887],[0 ,  0 ,  -1 ,  0],[9E9 ,  9E9 ,  9E9 ,  9E9 ,  9E9 ,  9E9]] ;
	CONST robtarget P20:=[[1448.9,1022.0,1332.8],[0.116061,-0.388408,0.906527,0.117806],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];CONST robtarget p30:=[[1430.883,1047.163,1332.771],[0.11502898,-0.39630415,0.90310271,0.11881433],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
	pers string sText:="nicht ""MoveL p99,v5,fine,tool0;"" hier ! kein Kommentar";
	proc main()
		TPWrite "Größe: [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
		movej   pÖse , V100 , Fine , TOOL0 ;MOVEL p20,v100,fine,tool0;
		MoveL P30,v100,fine,Tool0\WOBJ:=WOBJ0;!Ende
	endproc
endmodule
