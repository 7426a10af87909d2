MODULE Joints
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST jointtarget jHome:=[[0.0000,0.0000,0.0000,0.0000,30.0000,0.0000],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget jPark := [[-120.50, -40.00, 30.25, 170.00, -95.00, 181.00],[9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  CONST jointtarget jUnused:=[[5,5,5,5,5,5],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR jointtarget jNow;
  VAR jointtarget jSet:=[[5.0000,5.0000,5.0000,5.0000,5.0000,5.0000],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    MoveAbsJ jHome,v1000,z50,tGrip;
    MoveAbsJ jPark\NoEOffs,v1000,z50,tGrip\WObj:=wobj0;
    MoveAbsJ [[1.50000,2.50000,-3.50000,4.50000,-5.50000,6.50000],[9E9,9E9,9E9,9E9,9E9,9E9]],v1000,z50,tElsewhere;
    jNow:=CJointT();
    jNow.robax.rax_6:=0;
    MoveAbsJ jNow,v1000,z50,tGrip;
    jSet.robax.rax_1:=10;
    MoveAbsJ jSet,v1000,z50,tGrip;
    MoveAbsJ CalcJointT(pX,tGrip),v1000,z50,tGrip;
  ENDPROC
ENDMODULE
