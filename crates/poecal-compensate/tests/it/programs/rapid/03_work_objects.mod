MODULE Objects
  TASK PERS wobjdata wFix:=[FALSE,TRUE,"",[[1200,-340.5,650],[0.996195,0,0,0.0871557]],[[12.5,20,-3],[1,0,0,0]]];
  PERS wobjdata wTable:=[FALSE,TRUE,"",[[-200.25,1100,400],[1,0,0,0]],[[0,0,15],[0.707107,0,0,0.707107]]];
  PERS tooldata tTorch:=[TRUE,[[-10,5,318.25],[1,0,0,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST robtarget pA:=[[639.411,-211.786,205.222],[0.07614319,-0.08347769,0.99284444,0.03864718],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pB:=[[447.060,-1023.942,439.187],[0.07101502,0.74413432,0.62284369,-0.23083918],[0,-1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! reached in two work objects
  CONST robtarget pC:=[[282.206,-1281.043,365.005],[0.02759965,0.79062355,0.55966613,-0.24683290],[0,-1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC weld()
    MoveJ pA,v500,z5,tTorch\WObj:=wFix;
    MoveL pB,v500,z5,tTorch \WObj := wTable;
    MoveL pC,v500,z5,tTorch\WObj:=wTable;
    MoveL pC,v500,z5,tTorch\WObj:=wFix;
    MoveL pA,v500,z5,tTorch\WObj:=WFIX;
  ENDPROC
ENDMODULE
