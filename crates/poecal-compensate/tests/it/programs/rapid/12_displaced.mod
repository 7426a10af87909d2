MODULE Displaced
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  PERS pose peShift:=[[10,0,0],[1,0,0,0]];
  CONST robtarget p1:=[[1612.139,819.782,1104.550],[0.24206914,0.33348363,-0.91090923,0.02087037],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p2:=[[1597.586,847.792,1104.550],[0.24187780,0.34142001,-0.90796439,0.02298200],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p3:=[[1582.547,875.545,1104.550],[0.24166803,0.34933040,-0.90495040,0.02509188],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget j1:=[[27.0000,15.0000,10.0000,14.0000,50.0000,-20.0000],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveJ p1,v100,fine,tGrip;
    PDispSet peShift;
    MoveL p2,v100,fine,tGrip;
    SetDO doGrip,1;
    WaitTime 0.5;
    MoveAbsJ j1,v100,fine,tGrip;
    PDispOff;
    MoveL p3,v100,fine,tGrip;
    other;
  ENDPROC
  PROC other()
    MoveL p3,v100,fine,tGrip;
  ENDPROC
ENDMODULE
