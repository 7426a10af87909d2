MODULE Lines
  PERS tooldata tGrip:=
    [TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST robtarget
    pLong
    :=
    [[1549.518, ! a comment, 7
      -932.753, ! a comment, 7
      1104.550],[0.22183660, ! a comment, 7
      -0.14994621, ! a comment, 7
      -0.95837524, ! a comment, 7
      -0.09910381],[-1, ! a comment, 7
      0, ! a comment, 7
      -1, ! a comment, 7
      0],[9E9, ! a comment, 7
      9E9, ! a comment, 7
      9E9, ! a comment, 7
      9E9, ! a comment, 7
      9E9, ! a comment, 7
      9E9]]
    ;
  CONST robtarget pSigned:=[[1445.7601,-1078.6459,1107.6360],[0.239685451,-0.403924724,-0.881936379,-0.039798560],[-1,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pExpression:=[[100+200,0,900],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pNamed:=[posA,[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pLength:=[[900,0,900],[1,0,0.5,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveJ
      pLong,
      v100, ! how fast
      z10,
      tGrip
      ;
    MoveL pSigned,v100,z10,tGrip; MoveL pExpression,v100,z10,tGrip;
    MoveL pNamed,v100,z10,tGrip;
    MoveL pLength,v100,z10,tGrip;
  ENDPROC
ENDMODULE
