MODULE Relative
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST robtarget pPick:=[[1805.556,764.001,1044.444],[0.39384328,0.05595682,-0.91728955,-0.01833520],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pPlace:=[[1444.585,-1353.538,1003.510],[0.27604608,0.40628265,-0.85573981,0.16261104],[-1,0,-2,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC pick()
    MoveJ Offs(pPick,0,0,120),v1000,z20,tGrip;
    MoveL pPick,v100,fine,tGrip;
    MoveL RelTool(pPick,0,0,-50\Rz:=90),v100,z5,tGrip;
    MoveL Offs(RelTool(pPlace,0,0,-5),10*2,-3,nHigh),v100,z5,tGrip;
    MoveL Offs(CRobT(\Tool:=tGrip),0,0,50),v100,z5,tGrip;
  ENDPROC
ENDMODULE
