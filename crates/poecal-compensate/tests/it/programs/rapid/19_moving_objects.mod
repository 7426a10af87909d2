MODULE Moving
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  PERS wobjdata wHeld:=[TRUE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PERS wobjdata wBelt:=[FALSE,FALSE,"CNV1",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PERS wobjdata wUnit:=[FALSE,TRUE,"STN1",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PERS wobjdata wPart:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[nX,0,0],[1,0,0,0]]];
  VAR wobjdata wEmpty;
  PERS wobjdata wFix:=[FALSE,TRUE,"",[[1200,-340.5,650],[0.996195,0,0,0.0871557]],[[12.5,20,-3],[1,0,0,0]]];
  CONST robtarget p1:=[[1665.397,705.328,1104.550],[0.24265004,0.30149021,-0.92199274,0.01240957],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p2:=[[1652.834,734.285,1104.550],[0.24253251,0.30952453,-0.91932667,0.01452659],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p3:=[[1639.767,763.019,1104.550],[0.24239651,0.31753528,-0.91659059,0.01664250],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p4:=[[1626.201,791.521,1104.550],[0.24224205,0.32552185,-0.91378470,0.01875715],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p5:=[[1612.139,819.782,1104.550],[0.24206914,0.33348363,-0.91090923,0.02087037],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p6:=[[1597.586,847.792,1104.550],[0.24187780,0.34142001,-0.90796439,0.02298200],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p7:=[[345.536,-514.865,457.550],[0.21824279,-0.18330161,-0.95255839,-0.10678541],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveL p1,v100,fine,tGrip\WObj:=wHeld;
    MoveL p2,v100,fine,tGrip\WObj:=wBelt;
    MoveL p3,v100,fine,tGrip\WObj:=wUnit;
    MoveL p4,v100,fine,tGrip\WObj:=wPart;
    MoveL p5,v100,fine,tGrip\WObj:=wEmpty;
    MoveL p6,v100,fine,tGrip\WObj:=wElsewhere;
    MoveL p7,v100,fine,tGrip\WObj:=wFix;
  ENDPROC
ENDMODULE
