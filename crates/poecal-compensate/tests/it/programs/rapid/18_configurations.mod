MODULE Configurations
  CONST robtarget pFlip:=[[1641.712,669.896,1332.771],[0.12865139,-0.28328962,0.94466845,0.10391020],[0,2,-3,1],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTurns:=[[1641.712,669.896,1332.771],[0.15643215,-0.58930081,0.79080721,0.05364228],[0,0,3,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTurned:=[[1641.712,669.896,1332.771],[0.15643215,-0.58930081,0.79080721,0.05364228],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pQuarter:=[[-470.030,1786.732,1479.603],[0.47088978,-0.73172229,-0.26486692,0.41556085],[1,1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBorder:=[[1770.816,0.000,1328.646],[0.13052619,0.00000000,0.99144486,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBorderLow:=[[1770.816,0.000,1328.646],[0.13052619,0.00000000,0.99144486,0.00000000],[-1,-1,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBack:=[[1068.984,-685.582,2376.983],[0.20522757,0.27921940,-0.04561530,-0.93692978],[1,0,0,4],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pElbow:=[[-747.794,-209.133,2448.749],[0.80945649,-0.14809907,0.02611386,0.56759574],[0,0,0,6],[9E9,9E9,9E9,9E9,9E9,9E9]];
  ! two elbows in the same quarters, told apart by cfx
  CONST robtarget pUp:=[[482.658,222.464,2956.150],[0.61213530,0.08318284,0.55890906,0.55316512],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pDown:=[[501.233,229.084,2955.389],[0.60857578,0.08650442,0.56131168,0.55414953],[0,0,0,2],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pWrong:=[[1931.165,765.928,1967.653],[0.20619318,0.19039249,0.90612129,0.31651111],[1,1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pStraight:=[[2017.410,734.277,2145.305],[0.58682409,0.21984631,0.60402277,0.49240388],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pFar:=[[3500,0,2000],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pFraction:=[[1500,0,2000],[1,0,0,0],[0,0.5,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveJ pFlip,v100,fine,tool0;
    MoveJ pTurns,v100,fine,tool0;
    MoveJ pTurned,v100,fine,tool0;
    MoveJ pQuarter,v100,fine,tool0;
    MoveJ pBorder,v100,fine,tool0;
    MoveJ pBorderLow,v100,fine,tool0;
    MoveJ pBack,v100,fine,tool0;
    MoveJ pElbow,v100,fine,tool0;
    MoveJ pUp,v100,fine,tool0;
    MoveJ pDown,v100,fine,tool0;
    MoveJ pWrong,v100,fine,tool0;
    MoveJ pStraight,v100,fine,tool0;
    MoveJ pFar,v100,fine,tool0;
    MoveJ pFraction,v100,fine,tool0;
  ENDPROC
ENDMODULE
