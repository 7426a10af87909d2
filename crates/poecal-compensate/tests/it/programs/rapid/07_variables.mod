MODULE Variables
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  VAR robtarget pNow;
  VAR robtarget pLift:=[[1802.792,218.787,1066.863],[0.34934992,-0.04575089,-0.92961625,-0.10805150],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS robtarget pShift:=[[1798.699,250.217,1066.863],[0.35027953,-0.03763682,-0.92998009,-0.10499878],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS robtarget pKept:=[[1794.058,281.571,1066.863],[0.35118247,-0.02951988,-0.93027312,-0.10193805],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBase:=[[1788.871,312.838,1066.863],[0.35205866,-0.02140070,-0.93049531,-0.09886956],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pFrame:=[[1783.139,344.011,1066.863],[0.35290805,-0.01327988,-0.93064663,-0.09579355],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR pose peFix;
  FUNC robtarget above(robtarget p,num z)
    p.trans.z:=p.trans.z+z;
    RETURN p;
  ENDFUNC
  PROC main()
    pNow:=CRobT(\Tool:=tGrip\WObj:=wobj0);
    MoveL pNow,v100,z5,tGrip;
    pNow:=pBase;
    pLift.trans.z:=pLift.trans.z+100;
    MoveL pLift,v100,z5,tGrip;
    pShift:=Offs(pBase,0,0,10);
    MoveL pShift,v100,z5,tGrip;
    MoveL pKept,v100,z5,tGrip;
    MoveL pBase,v100,z5,tGrip;
    MoveL above(pBase,50),v100,z5,tGrip;
    peFix:=DefFrame(pFrame,pKept2,pBase2);
    MoveL pFrame,v100,z5,tGrip;
    MoveL pElsewhere,v100,z5,tGrip;
    IF Distance(pNow.trans,pBase.trans)>5 Stop;
  ENDPROC
ENDMODULE
