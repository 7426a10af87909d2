MODULE Routines
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST robtarget pAbove:=[[1612.139,819.782,1104.550],[0.24206914,0.33348363,-0.91090923,0.02087037],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pOwn:=[[1597.586,847.792,1104.550],[0.24187780,0.34142001,-0.90796439,0.02298200],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p10:=[[1582.547,875.545,1104.550],[0.24166803,0.34933040,-0.90495040,0.02509188],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    CONST robtarget pLocal:=[[1567.026,903.031,1104.550],[0.24143987,0.35721418,-0.90186750,0.02719985],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    approach pAbove,tGrip,50;
    MoveL pOwn,v100,fine,tGrip;
    MoveL pLocal,v100,fine,tGrip;
    inner;
  ENDPROC
  PROC approach(robtarget pTo,PERS tooldata tTo,num nHigh\switch slow|switch fast)
    MoveJ Offs(pTo,0,0,nHigh),v500,z10,tTo;
    MoveL pTo,v100,fine,tTo;
  ENDPROC
  LOCAL PROC inner()
    ! hides the other one
    CONST robtarget p10:=[[1596.349,-771.782,1332.771],[0.15979298,0.12543332,0.97822184,0.04259946],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    MoveL p10,v100,fine,tool0;
  ENDPROC
  TRAP stopped
    MoveL p10,v100,fine,tGrip;
  ENDTRAP
ENDMODULE
