//! Projects of OpenGeoSys that tests write: mechanics of the plane with fractures (LIE).

/// A project of the plane, from what tests differ in.
pub struct Story<'a> {
    /// Width and height of the body (m).
    pub size: [f64; 2],
    /// The fracture model without its stiffnesses.
    pub law: &'a str,
    /// Material numbers of the fractures.
    pub fractures: &'a [usize],
    pub constants: &'a [[&'a str; 2]],
    /// Name, times, factors, and the constant that is scaled.
    pub curves: &'a [[&'a str; 4]],
    /// Variable, place, kind, axis, parameter.
    pub conditions: &'a [[&'a str; 5]],
    /// Number and length of the load steps.
    pub steps: (usize, f64),
}

impl Story<'_> {
    /// A geometry with the sides of the body, and its corner.
    pub fn geometry(&self) -> String {
        let [x, y] = self.size;
        let line = |name: &str, a: usize, b: usize| {
            format!("<polyline id=\"0\" name=\"{name}\"><pnt>{a}</pnt><pnt>{b}</pnt></polyline>")
        };
        let sides = [
            line("BOTTOM", 0, 1),
            line("TOP", 2, 3),
            line("LEFT", 0, 2),
            line("RIGHT", 1, 3),
        ];
        format!(
            "<OpenGeoSysGLI><name>body</name><points>\
             <point id=\"0\" x=\"0\" y=\"0\" z=\"0\" name=\"CORNER\"/>\
             <point id=\"1\" x=\"{x}\" y=\"0\" z=\"0\"/><point id=\"2\" x=\"0\" y=\"{y}\" z=\"0\"/>\
             <point id=\"3\" x=\"{x}\" y=\"{y}\" z=\"0\"/>\
             <point id=\"4\" x=\"0\" y=\"1\" z=\"0\" name=\"END\"/></points>\
             <polylines>{}</polylines></OpenGeoSysGLI>",
            sides.concat()
        )
    }

    fn process(&self) -> String {
        let fractures = self.fractures.iter().map(|id| {
            format!(
                "<fracture_properties><material_id>{id}</material_id>\
                 <initial_aperture>b</initial_aperture></fracture_properties>"
            )
        });
        format!(
            "<processes><process><name>SD</name><type>SMALL_DEFORMATION_WITH_LIE</type>\
             <constitutive_relation><type>LinearElasticIsotropic</type>\
             <youngs_modulus>E</youngs_modulus><poissons_ratio>nu</poissons_ratio>\
             </constitutive_relation><fracture_model><normal_stiffness>Kn</normal_stiffness>\
             <shear_stiffness>Ks</shear_stiffness>{}</fracture_model>{}</process></processes>",
            self.law,
            fractures.collect::<String>()
        )
    }

    fn parameters(&self) -> String {
        let constants = self.constants.iter().map(|[name, value]| {
            format!(
                "<parameter><name>{name}</name><type>Constant</type><value>{value}</value>\
                 </parameter>"
            )
        });
        let scaled = self.curves.iter().map(|[name, _, _, of]| {
            format!(
                "<parameter><name>{name}</name><type>CurveScaled</type><curve>{name}</curve>\
                 <parameter>{of}</parameter></parameter>"
            )
        });
        let curves = self.curves.iter().map(|[name, times, values, _]| {
            format!(
                "<curve><name>{name}</name><coords>{times}</coords><values>{values}</values></curve>"
            )
        });
        format!(
            "<parameters>{}</parameters><curves>{}</curves>",
            constants.chain(scaled).collect::<String>(),
            curves.collect::<String>()
        )
    }

    fn variables(&self) -> String {
        let conditions = self
            .conditions
            .iter()
            .map(|[variable, place, kind, axis, parameter]| {
                format!(
                    "<process_variable><name>{variable}</name><boundary_conditions>\
                     <boundary_condition><geometry>{place}</geometry><type>{kind}</type>\
                     <component>{axis}</component><parameter>{parameter}</parameter>\
                     </boundary_condition></boundary_conditions></process_variable>"
                )
            });
        let conditions: String = conditions.collect();
        format!("<process_variables>{conditions}</process_variables>")
    }

    /// The text of the project file.
    pub fn project(&self) -> String {
        let (repeat, step) = self.steps;
        let end = repeat as f64 * step;
        format!(
            "<OpenGeoSysProject><mesh>column.vtu</mesh><geometry>column.gml</geometry>{}\
             <time_loop><processes><process><time_stepping><type>FixedTimeStepping</type>\
             <t_initial>0</t_initial><t_end>{end}</t_end><timesteps><pair><repeat>{repeat}</repeat>\
             <delta_t>{step}</delta_t></pair></timesteps></time_stepping></process></processes>\
             </time_loop>{}{}</OpenGeoSysProject>",
            self.process(),
            self.parameters(),
            self.variables()
        )
    }
}
