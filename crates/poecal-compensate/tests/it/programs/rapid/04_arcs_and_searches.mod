MODULE Arcs
  PERS tooldata tTorch:=[TRUE,[[-10,5,318.25],[1,0,0,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  PERS wobjdata wFix:=[FALSE,TRUE,"",[[1200,-340.5,650],[0.996195,0,0,0.0871557]],[[12.5,20,-3],[1,0,0,0]]];
  CONST robtarget p1:=[[627.851,-358.072,166.063],[0.01962901,0.40042130,0.90933215,0.11132168],[-1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pVia:=[[741.948,-238.253,123.330],[0.03278176,0.34270217,0.92988714,0.12957811],[-1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p2:=[[757.030,-64.303,179.315],[0.02943732,0.28119041,0.94658577,0.15505091],[-1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p3:=[[752.790,83.401,225.694],[0.01942435,0.27434012,0.94833188,0.15819874],[-1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p4:=[[778.905,216.169,225.694],[0.01389146,0.24107670,0.95732851,0.15878027],[-1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p5:=[[797.134,367.292,225.694],[0.00764707,0.20330629,0.96605507,0.15920323],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR robtarget pFound;
  VAR triggdata gunOn;
  PROC main()
    TriggIO gunOn,5\DOp:=doGun,1;
    MoveL p1,v200,z5,tTorch\WObj:=wFix;
    MoveC pVia,p2,v100,z1,tTorch\WObj:=wFix;
    TriggL p3,v100,gunOn,fine,tTorch\WObj:=wFix;
    TriggC p4,p5,v100,gunOn,fine,tTorch\WObj:=wFix;
    SearchL\Stop,diTouch,pFound,p3,v20,tTorch\WObj:=wFix;
    MoveL pFound,v20,fine,tTorch\WObj:=wFix;
    MoveLDO p1,v200,z5,tTorch\WObj:=wFix,doGun,0;
  ENDPROC
ENDMODULE
