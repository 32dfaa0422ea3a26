model Scooter "Longitudinal motion of a light electric two-wheeler and its motor drive"
  // Dardanelli et al., "Speed and acceleration controllers for a light electric two-wheeled vehicle", CDC-ECC 2011.
  // The equations are numbered as in models/scooter.py, in Modelica as in the book: no step, no solver.
  // Conditions stand in noEvent(), since the step of rumoca's Co-Simulation FMUs looks at no events.
  constant Real g(unit="m/s2") = 9.81 "Gravity";
  constant Real gain(unit="m/s") = 46.0/3.6 "Steady speed gained by full throttle: 0.46 km/h per % (published)";
  constant Real pole(unit="rad/s") = 0.06*3.141592653589793 "Pole at v_match: 0.03 Hz (published)";
  constant Real v_match(unit="m/s") = 30.0/3.6 "Speed at which gain and pole were measured (published)";

  parameter Real m(unit="kg", min=1.0) = 200.0 "Mass of vehicle and rider";
  parameter Real rho(unit="kg/m3", min=0.0) = 1.2 "Density of the air";
  parameter Real CdA(unit="m2", min=0.0) = 0.60 "Drag coefficient times frontal area";
  parameter Real r_v(unit="N.s/m", min=0.0) = 10.0 "Resistance proportional to the speed";
  parameter Real C_r(unit="1", min=0.0) = 0.014 "Rolling resistance coefficient";
  parameter Real F_max(unit="N", min=0.0) = 850.0 "Limit of the drive's force at low speed";
  parameter Real tau(unit="s", min=1e-6) = 0.005 "Lag of the drive's current loop";
  parameter Real v_limit(unit="m/s", min=0.0) = 50.0/3.6 "Speed limit of the drive";
  parameter Real v_band(unit="m/s", min=1e-3) = 1.0/3.6 "Band in which the drive's force fades out";
  parameter Real eta(unit="1", min=0.01, max=1.0) = 0.85 "Efficiency from battery to wheel";
  parameter Real P_aux(unit="W", min=0.0) = 40.0 "Drawn by everything but the drive";
  parameter Real r_f(unit="m", min=0.01) = 0.2 "Rolling radius of the front wheel";
  parameter Real r_r(unit="m", min=0.01) = 0.2 "Rolling radius of the rear wheel";

  input Real throttle(unit="1", start=0.0) "Throttle, 0..1";
  input Real F_brake(unit="N", start=0.0) "Force of the friction brakes";
  input Real alpha(unit="rad", start=0.0) "Angle of the road, positive uphill";

  output Real v(unit="m/s", min=0.0) "Speed";
  output Real a(unit="m/s2") "Acceleration";
  output Real w_f(unit="rad/s", min=0.0) "Speed of the front wheel";
  output Real w_r(unit="rad/s", min=0.0) "Speed of the rear wheel";
  output Real P(unit="W") "Electrical power at the battery terminals";
  output Real F(unit="N") "Force of the drive at the wheel";
  output Real s(unit="m") "Distance traveled";

protected
  // (S2) belongs to the drive: it was matched to the road load R_0 + v (R_1 + R_2 v) of a vehicle of 200 kg.
  final parameter Real R_0(unit="N") = 200.0*g*0.014;
  final parameter Real R_1(unit="N.s/m") = 10.0;
  final parameter Real R_2(unit="kg/m") = 0.36;
  final parameter Real v_knee(unit="m/s") = v_match - (R_0 + v_match*(R_1 + R_2*v_match))/(200.0*pole)
    "Up to this speed nothing but F_max limits the force";

  Real x_v(unit="m/s", start=0.0, fixed=true) "Speed, state";
  Real x_F(unit="N", start=0.0, fixed=true) "Force of the drive, state";
  Real x_s(unit="m", start=0.0, fixed=true) "Distance, state";
  Real F_map(unit="N") "Force of full throttle";
  Real F_road(unit="N") "Brake, rolling resistance, drag and grade";
  Real a_free(unit="m/s2") "Acceleration, were it allowed to roll backward";
equation
  // (S2): the force map; (S3): the drive's speed limit
  F_map = noEvent(if x_v > v_knee then min(F_max, gain*(R_0 + x_v*(R_1 + R_2*x_v))/(x_v - v_knee)) else F_max)
    *max(0.0, min(1.0, (v_limit + 0.5*v_band - x_v)/v_band));
  // (S1): the drive's current loop
  tau*der(x_F) = min(1.0, max(0.0, throttle))*F_map - x_F;
  // (2): resistance
  F_road = max(0.0, F_brake) + m*g*(C_r*cos(alpha) + sin(alpha)) + x_v*(r_v + 0.5*rho*CdA*x_v);
  // (1): motion; a vehicle that stands does not roll backward
  a_free = (x_F - F_road)/m;
  der(x_v) = noEvent(if x_v <= 0.0 and a_free < 0.0 then 0.0 else a_free);
  der(x_s) = max(0.0, x_v);

  v = max(0.0, x_v);
  a = noEvent(if x_v <= 0.0 and a_free < 0.0 then 0.0 else a_free);
  w_f = v/r_f;
  w_r = v/r_r;
  P = x_F*v/eta + P_aux;
  F = x_F;
  s = x_s;
end Scooter;
