MODULE Simple
  ! One tool, the robot's own frame.
  PERS tooldata tGrip:=[TRUE,[[31.792,-12.5,229.639],[0.92388,0,0.382683,0]],[4.5,[0,0,90],[1,0,0,0],0,0,0]];
  CONST robtarget pHome:=[[1258.128,-12.500,1705.665],[0.13052562,0.00000000,-0.99144494,0.00000000],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p10:=[[1505.536,1113.972,977.763],[0.11234085,0.74441671,-0.60353609,0.26261662],[0,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget p20:=[[847.864,-1892.166,1149.755],[0.13663992,0.96351407,0.02058134,0.22923041],[-1,-1,1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC main()
    MoveJ pHome,v1000,z50,tGrip;
    MoveL p10,v200,fine,tGrip;
    MoveL p20,v200,z10,tGrip\WObj:=wobj0;
    MoveJ pHome,v1000,fine,tGrip;
  ENDPROC
ENDMODULE
