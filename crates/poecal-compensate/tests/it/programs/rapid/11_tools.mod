MODULE Tools
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  PERS tooldata tTorch:=[TRUE,[[-10,5,318.25],[1,0,0,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  PERS tooldata tFixed:=[FALSE,[[900,0,600],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  PERS tooldata tSet:=[TRUE,[[-10,5,318.25],[1,0,0,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST robtarget pGrip:=[[1612.139,819.782,1104.550],[0.24206914,0.33348363,-0.91090923,0.02087037],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTorch:=[[1648.084,881.860,1035.565],[0.12494661,-0.31608551,0.93420632,0.10833677],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBoth:=[[1632.443,910.488,1035.565],[0.12399645,-0.32422585,0.93141241,0.10942299],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pFixed:=[[1562.695,837.831,1332.771],[0.12303684,-0.33234151,0.92854758,0.11050089],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pSet:=[[1599.672,966.905,1035.565],[0.12206787,-0.34043186,0.92561203,0.11157037],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pOther:=[[1582.554,994.676,1035.565],[0.12108959,-0.34849629,0.92260600,0.11263135],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pChosen:=[[1564.954,1022.144,1035.565],[0.12010210,-0.35653417,0.91952970,0.11368375],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveJ pGrip,v100,fine,tGrip;
    MoveJ pTorch,v100,fine,tTorch;
    MoveL pBoth,v100,fine,tTorch;
    MoveL pBoth,v100,fine,tGrip;
    MoveL pFixed,v100,fine,tFixed;
    tSet.tframe.trans.z:=320;
    MoveL pSet,v100,fine,tSet;
    MoveL pOther,v100,fine,tElsewhere;
    MoveL pChosen,v100,fine,tools{nTool};
    MoveJ pGrip,v100,fine,tGrip;
  ENDPROC
ENDMODULE
