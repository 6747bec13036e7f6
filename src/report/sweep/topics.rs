/// Heading, title, y axis and columns of a figure, the latter with their names.
pub(super) struct Topic {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) quantity: (&'static str, &'static str),
    pub(super) columns: &'static [(&'static str, &'static str)],
    pub(super) caption: &'static str,
}

/// What there may be a figure of, in the order of the page.
pub(super) const TOPICS: [Topic; 8] = [
    Topic {
        id: "torque-ratio",
        title: "Peak torque, flexible over rigid",
        quantity: ("ratio", ""),
        columns: &[("torque_ratio", "ratio")],
        caption: "Peak torque of the flexible link over that of the rigid one. It tends to 1 where the \
                  link is stiff for this motion.",
    },
    Topic {
        id: "lead",
        title: "Lead",
        quantity: ("lead", "s"),
        columns: &[("lead_s", "lead")],
        caption: "How long before the tip moves the torque begins, at 2 % of its peak.",
    },
    Topic {
        id: "lag",
        title: "Lag",
        quantity: ("lag", "s"),
        columns: &[("lag_s", "lag")],
        caption: "How long the torque goes on after the tip has stopped, at 2 % of its peak.",
    },
    Topic {
        id: "peak-torque",
        title: "Peak torque",
        quantity: ("torque", "N m"),
        columns: &[("peak_torque_n_m", "flexible link"), ("peak_rigid_torque_n_m", "rigid link")],
        caption: "Largest torque at the hub.",
    },
    Topic {
        id: "peak-motor-torque",
        title: "Peak torque of the motor",
        quantity: ("torque", "N m"),
        columns: &[("peak_motor_torque_n_m", "motor")],
        caption: "Largest torque of the motor, on its own side of the gear.",
    },
    Topic {
        id: "residual",
        title: "Vibration left behind",
        quantity: ("amplitude", "m"),
        columns: &[("residual_m", "residual")],
        caption: "How far the tip vibrates after the torque's last sample.",
    },
    Topic {
        id: "tip-error",
        title: "Error of the tip",
        quantity: ("error", "m"),
        columns: &[("tip_error_m", "largest error")],
        caption: "How far the tip strays from the wanted motion, at most.",
    },
    Topic {
        id: "deflection",
        title: "Peak deflection",
        quantity: ("deflection", "m"),
        columns: &[("peak_deflection_m", "tip")],
        caption: "Largest deflection of the tip from the hub's tangent line.",
    },
];
