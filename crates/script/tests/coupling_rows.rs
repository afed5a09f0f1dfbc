//! The scan script for each row of the events at coupled axes: a row without a script is a failing test.
//!
//! Names are those of `scan-tests/coupling`, or of a folder beside it. The reaction of each block to each
//! value at its pins is in `blocks/tests/bad_input`.

use super::common::scan_tests;

/// An event, and the scripts that show it.
type Row = (&'static str, &'static [&'static str]);

/// Events that begin, end or keep the state of a slave.
const STATES: &[Row] = &[
    (
        "taken from Standstill",
        &[
            "gear_at_rest_follows_in_the_same_scan",
            "combine_adds",
            "cams/the_table_of_the_reference",
        ],
    ),
    (
        "taken from DiscreteMotion, ContinuousMotion, SynchronizedMotion",
        &["taken_from_every_motion", "gear_of_the_standard"],
    ),
    (
        "refused from Disabled, Homing, Stopping, ErrorStop",
        &[
            "refused_in_states_and_by_pins",
            "no_gear_for_an_axis_that_homes",
            "no_coupling_of_a_slave_that_cannot_move",
        ],
    ),
    (
        "buffered",
        &[
            "buffered_on_both_sides",
            "combine_buffered_and_left",
            "cams/from_cam_to_cam",
        ],
    ),
    (
        "before the start point",
        &[
            "in_pos_waits_for_its_direction",
            "in_pos_is_stopped_before_its_start",
            "cams/starts_that_wait",
        ],
    ),
    (
        "the start point is crossed",
        &["in_pos_of_the_standard", "cams/a_start_that_waits_for_its_master"],
    ),
    (
        "MC_GearOut, MC_CamOut, also at rest",
        &[
            "gear_out_keeps_the_velocity",
            "gear_out_while_it_accelerates",
            "gear_out_at_rest",
            "cams/let_go_of_a_cam",
        ],
    ),
    (
        "MC_Halt on the slave",
        &[
            "other_commands_take_over",
            "gear_out_keeps_the_velocity",
            "cams/let_go_of_a_cam",
        ],
    ),
    (
        "another motion command on the slave",
        &["other_commands_take_over", "in_pos_is_stopped_before_its_start"],
    ),
    (
        "MC_Stop on the slave",
        &["other_commands_take_over", "in_pos_is_stopped_before_its_start"],
    ),
    (
        "MC_MoveSuperimposed on the slave",
        &["superimposed_of_the_standard", "cams/superimposed_on_a_cam"],
    ),
    ("MC_Home on the slave", &["the_master_homes"]),
    (
        "power off and faults of the slave",
        &[
            "what_ends_a_coupling_at_the_slave",
            "a_fault_of_the_slave_leaves_the_master_alone",
        ],
    ),
    (
        "lag",
        &[
            "a_slave_that_cannot_follow_lags",
            "combine_says_at_once_that_it_cannot_follow",
            "cams/too_fast_for_the_cam",
        ],
    ),
    ("the end of a cam without periods", &["cams/without_periods"]),
];

/// Events at the master, and the reaction of its slave by set values.
const BY_SET_VALUES: &[Row] = &[
    (
        "any command, an override, MC_Stop, buffering, blending",
        &[
            "a_chain_moves_in_one_scan",
            "override_probe_and_switch_of_a_slave",
            "the_master_is_switched_off_or_stopped",
        ],
    ),
    ("at rest", &["gear_at_rest_follows_in_the_same_scan"]),
    (
        "MC_SetPosition",
        &["coordinates_move_under_a_gear", "cams/coordinates_and_stops"],
    ),
    (
        "MC_Halt, then in reverse",
        &["a_master_that_goes_back", "cams/backwards_and_trembling"],
    ),
    (
        "the ramp of power off",
        &["the_master_is_switched_off_or_stopped"],
    ),
    (
        "the ramp of an axis error",
        &["the_master_stops_by_an_axis_error", "slow_master_and_a_fault"],
    ),
    (
        "its set-point jumps to the feedback",
        &[
            "the_master_loses_power_in_motion",
            "on_master_lost_hold",
            "combine_loses_one_master",
            "cams/the_master_is_lost",
        ],
    ),
    ("homing", &["the_master_homes"]),
    ("a torque", &["a_master_that_comes_under_a_torque_is_lost"]),
];

/// The same by actual values.
const BY_ACTUAL_VALUES: &[Row] = &[
    (
        "any command",
        &[
            "in_pos_of_a_measured_master",
            "a_chain_behind_a_measured_master",
            "actual_lead_makes_up_for_the_filter",
        ],
    ),
    ("at rest", &["actual_values_at_rest_do_not_tremble"]),
    ("MC_SetPosition", &["coordinates_move_under_measured_masters"]),
    (
        "MC_Halt, then in reverse",
        &["a_measured_master_turns_back_and_homes"],
    ),
    (
        "the ramps of power off and of an axis error",
        &[
            "a_master_without_power_is_followed_by_its_actual_values",
            "the_master_stops_by_an_axis_error",
        ],
    ),
    (
        "its set-point jumps to the feedback",
        &["a_master_without_power_is_followed_by_its_actual_values"],
    ),
    (
        "without feedback",
        &["a_measured_master_without_feedback_is_lost"],
    ),
    ("homing", &["a_measured_master_turns_back_and_homes"]),
    ("a torque", &["a_master_under_a_torque_is_followed"]),
];

/// Commands to the slave that do not end its coupling, and obstacles on its path.
const ON_THE_SLAVE: &[Row] = &[
    (
        "MC_SetOverride",
        &[
            "override_probe_and_switch_of_a_slave",
            "barred_slave_waits_and_catches_up",
            "cams/coordinates_and_stops",
        ],
    ),
    (
        "EnablePositive, EnableNegative FALSE",
        &[
            "barred_slave_waits_and_catches_up",
            "barred_slaves_of_two_masters_and_of_a_cam",
        ],
    ),
    (
        "software limits",
        &[
            "software_limit_of_the_slave",
            "a_master_commanded_beyond_the_slaves_limit",
            "superimposed_within_software_limits",
        ],
    ),
    (
        "limit switch, following error, drive fault",
        &[
            "what_ends_a_coupling_at_the_slave",
            "a_fault_of_the_slave_leaves_the_master_alone",
        ],
    ),
    (
        "MC_SetPosition",
        &[
            "coordinates_move_under_a_gear",
            "coordinates_move_under_measured_masters",
            "cams/coordinates_and_stops",
        ],
    ),
    ("MC_WriteParameter of a limit", &["a_limit_of_a_slave_is_written"]),
    (
        "MC_MoveSuperimposed waits for room",
        &["superimposed_waits_for_room", "superimposed_gives_way"],
    ),
    (
        "MC_TouchProbe, MC_DigitalCamSwitch",
        &["override_probe_and_switch_of_a_slave"],
    ),
];

#[test]
fn every_row_has_its_scripts() {
    let folder = scan_tests();
    for (what, scripts) in [STATES, BY_SET_VALUES, BY_ACTUAL_VALUES, ON_THE_SLAVE].concat() {
        assert!(!scripts.is_empty(), "{what}");
        for script in scripts {
            let name = if script.contains('/') {
                (*script).to_owned()
            } else {
                format!("coupling/{script}")
            };
            let path = folder.join(format!("{name}.scan.json"));
            assert!(path.is_file(), "{what}: {}", path.display());
        }
    }
}
