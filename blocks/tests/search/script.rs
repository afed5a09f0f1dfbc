//! A counterexample as a scan script: the shortest path from Standstill to the broken rule.

use crate::system::{AxisEvent, Inputs};
use std::fmt::Write;

/// The script that applies `path`, one step per scan from scan 1 on.
pub fn print(first: &str, second: &str, path: &[Inputs]) -> String {
    let motion = |name: &str, block: &str, position: &str| {
        let goal = match block {
            "MC_MoveAbsolute" => format!(", \"Position\": {position}, \"Velocity\": 1"),
            "MC_MoveVelocity" => ", \"Velocity\": 1".to_string(),
            "MC_Jog" | "MC_MoveRelative" | "MC_MoveAdditive" => ", \"Velocity\": 2".to_string(),
            "MC_MoveContinuousAbsolute" => {
                format!(", \"Position\": {position}, \"Velocity\": 1, \"EndVelocity\": 1")
            }
            "MC_MoveContinuousRelative" => ", \"Velocity\": 1, \"EndVelocity\": 1".to_string(),
            "MC_SetPosition" => format!(", \"Position\": {position}, \"ExecutionMode\": 1"),
            "MC_MoveSuperimposed" => ", \"VelocityDiff\": 2".to_string(),
            "MC_Home" => format!(", \"Position\": {position}"),
            _ => String::new(),
        };
        format!("    {{\"name\": \"{name}\", \"type\": \"{block}\", \"pins\": {{\"Axis\": \"X\"{goal}}}}}")
    };
    let mut text = format!(
        "{{\n  \"standstill\": 1,\n  \"title\": \"Counterexample\",\n  \"cycle\": \"T#1ms\",\n  \"scans\": {},\n  \
         \"axes\": {{\"X\": {{\"limits\": {{\"velocity\": 10, \"acceleration\": 1000}}, \"queue\": 1, \"state\": \"Standstill\"}}}},\n  \
         \"blocks\": [\n    {{\"name\": \"reset\", \"type\": \"MC_Reset\", \"pins\": {{\"Axis\": \"X\"}}}},\n    {{\"name\": \"again\", \"type\": \"MC_Reset\", \"pins\": {{\"Axis\": \"X\"}}}},\n    {{\"name\": \"power\", \"type\": \"MC_Power\", \"pins\": {{\"Axis\": \"X\", \"Enable\": true}}}},\n{},\n    \
         {{\"name\": \"stop\", \"type\": \"MC_Stop\", \"pins\": {{\"Axis\": \"X\"}}}},\n\
{}\n  ],\n  \"steps\": [\n",
        path.len() + 5,
        motion("first", first, "1"),
        motion("second", second, "0"),
    );
    let mut steps = Vec::new();
    let mut before = Inputs {
        enable: true,
        ..Inputs::default()
    };
    for (scan, inputs) in (1..).zip(path) {
        let mut set = Vec::new();
        for (name, index, block) in [("first", 0, first), ("second", 1, second)] {
            if inputs.mode[index] != before.mode[index] {
                set.push(format!("\"{name}.BufferMode\": {}", inputs.mode[index]));
            }
            if inputs.execute[index] != before.execute[index] {
                let trigger = if block == "MC_Jog" {
                    "JogForward"
                } else {
                    "Execute"
                };
                set.push(format!("\"{name}.{trigger}\": {}", inputs.execute[index]));
            }
        }
        let plain = [
            ("stop.Execute", inputs.stop, before.stop),
            ("power.Enable", inputs.enable, before.enable),
        ];
        set.extend(
            plain
                .iter()
                .filter(|(_, now, was)| now != was)
                .map(|(pin, now, _)| format!("\"{pin}\": {now}")),
        );
        let mut step = format!("    {{\"at\": {scan}");
        if !set.is_empty() {
            let _ = write!(step, ", \"set\": {{{}}}", set.join(", "));
        }
        match inputs.event {
            AxisEvent::Nothing => {}
            AxisEvent::AxisFault => step.push_str(&fault("axis")),
            AxisEvent::DriveFault => step.push_str(&fault("drive")),
            AxisEvent::PowerLoss => step.push_str(&fault("power")),
            // A pulse: the step above has set it, the next one resets it.
            AxisEvent::Reset => {}
            AxisEvent::CausesGone => step.push_str(", \"clear\": {\"axis\": \"X\"}"),
        }
        step.push('}');
        if !set.is_empty() || inputs.event != AxisEvent::Nothing {
            steps.push(step);
        }
        before = *inputs;
    }
    text.push_str(&steps.join(",\n"));
    text.push_str("\n  ]\n}\n");
    text
}

fn fault(kind: &str) -> String {
    format!(", \"fault\": {{\"axis\": \"X\", \"kind\": \"{kind}\", \"code\": 7}}")
}
