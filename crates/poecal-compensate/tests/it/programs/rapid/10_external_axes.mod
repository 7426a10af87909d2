MODULE Track
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST robtarget pNone:=[[1730.001,527.382,1104.550],[0.24296697,0.25282365,-0.93650796,-0.00030676],[0,0,-1,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
  CONST robtarget pZero:=[[1720.533,557.495,1104.550],[0.24296039,0.26098649,-0.93426603,0.00181351],[0,0,-1,0],[0,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTrack:=[[1710.541,587.437,1104.550],[0.24293531,0.26912946,-0.93195294,0.00393364],[0,0,-1,0],[1250.5,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pTable:=[[1700.029,617.201,1104.550],[0.24289174,0.27725194,-0.92956889,0.00605348],[0,0,-1,0],[9E9,-90,9E9,9E9,9E9,9E9]];
  CONST jointtarget jTrack:=[[18.0000,15.0000,10.0000,14.0000,50.0000,-20.0000],[1250.5,1250.5,1250.5,1250.5,1250.5,1250.5]];
  CONST jointtarget jTable:=[[9E9,9E9,9E9,9E9,9E9,9E9],[90,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    EOffsOn;
    MoveJ pNone,v100,fine,tGrip;
    MoveJ pZero,v100,fine,tGrip;
    MoveJ pTrack,v100,fine,tGrip;
    MoveJ pTable,v100,fine,tGrip;
    MoveAbsJ jTrack\NoEOffs,v100,fine,tGrip;
    MoveExtJ jTable,vrot50,fine;
    EOffsOff;
  ENDPROC
ENDMODULE
