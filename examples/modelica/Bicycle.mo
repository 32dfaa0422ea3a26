model Bicycle "Lateral motion of a car whose front and rear wheels are steered, at constant speed"
  // A paper on optimal lane keeping control of a 4WS electric vehicle, section 4, written with the forces of the axles.
  // The axes are those of ISO 8855: y to the left, so that y counts against the paper's displacement beta.
  parameter Real m(unit="kg", min=1.0) = 1380.0 "Mass";
  parameter Real J_z(unit="kg.m2", min=1.0) = 2200.0 "Moment of inertia about the vertical axis";
  parameter Real C_f(unit="N/rad", min=0.0) = 30000.0 "Cornering stiffness of one front tire";
  parameter Real C_r(unit="N/rad", min=0.0) = 30000.0 "Cornering stiffness of one rear tire";
  parameter Real l_f(unit="m", min=0.0) = 1.25 "Center of gravity to front axle";
  parameter Real l_r(unit="m", min=0.0) = 1.27 "Center of gravity to rear axle";
  parameter Real v_x(unit="m/s", min=0.1) = 21.3 "Longitudinal speed";

  input Real delta_f(unit="rad", start=0.0) "Front road-wheel angle";
  input Real delta_r(unit="rad", start=0.0) "Rear road-wheel angle";

  output Real v_y(unit="m/s") "Lateral velocity";
  output Real psi(unit="rad") "Heading relative to the lane";
  output Real w_z(unit="rad/s") "Yaw rate";
  output Real y(unit="m") "Displacement from the lane center, to the left";

protected
  Real x_v(unit="m/s", start=0.0, fixed=true) "Lateral velocity, state";
  Real x_psi(unit="rad", start=0.0, fixed=true) "Heading, state";
  Real x_w(unit="rad/s", start=0.0, fixed=true) "Yaw rate, state";
  Real x_y(unit="m", start=0.0, fixed=true) "Displacement, state";
  Real F_f(unit="N") "Lateral force of the front axle";
  Real F_r(unit="N") "Lateral force of the rear axle";
equation
  // Two tires an axle; linear in the slip angle.
  F_f = 2.0*C_f*(delta_f - (x_v + l_f*x_w)/v_x);
  F_r = 2.0*C_r*(delta_r - (x_v - l_r*x_w)/v_x);
  m*(der(x_v) + v_x*x_w) = F_f + F_r;
  J_z*der(x_w) = l_f*F_f - l_r*F_r;
  der(x_psi) = x_w;
  der(x_y) = x_v + v_x*x_psi;

  v_y = x_v;
  psi = x_psi;
  w_z = x_w;
  y = x_y;
end Bicycle;
