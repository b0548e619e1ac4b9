package FilmContact "Mechanical flanges for contact FMUs of film-model"
  partial block ContactForce "Inputs and output that a contact FMU has after its import"
    input Real indentation(unit = "m");
    input Real relative_velocity(unit = "m/s");
    output Real contact_force(unit = "N");
  end ContactForce;

  model Contact "The body at flange_a hits the body at flange_b, in the direction of s"
    extends Modelica.Mechanics.Translational.Interfaces.PartialTwoFlanges;
    replaceable ContactForce fmu constrainedby ContactForce "Redeclare as the imported contact FMU";
    parameter Modelica.Units.SI.Length gap = 0 "flange_b.s less flange_a.s at first touch";
  equation
    fmu.indentation = flange_a.s - flange_b.s + gap;
    fmu.relative_velocity = der(flange_a.s) - der(flange_b.s);
    flange_a.f = fmu.contact_force;
    flange_b.f = -fmu.contact_force;
  end Contact;
end FilmContact;
