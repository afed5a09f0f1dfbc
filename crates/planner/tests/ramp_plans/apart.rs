//! Acceleration and deceleration a factor of thousands apart, as found by chains of random replans.

use standstill_planner::{Excess, Limits, OnlinePlan, RampPlan, Segment, Setpoint};

#[derive(Clone, Copy, Debug)]
enum Goal {
    Position(f64),
    Passing(f64, f64),
    Velocity(f64),
}

/// A plan of either kind.
#[derive(Debug)]
struct Plan {
    segments: Vec<Segment>,
    excess: Option<Excess>,
    /// The state at the scan in which the next plan begins.
    left: Setpoint,
}

fn plan(start: &Setpoint, goal: Goal, limits: &Limits, before: &Limits, cycle: f64, scan: u64) -> Plan {
    let to_position = |plan: OnlinePlan| Plan {
        segments: plan.segments().collect(),
        excess: plan.excess(),
        left: plan.at(scan),
    };
    match goal {
        Goal::Position(target) => {
            to_position(OnlinePlan::new(start, target, limits, before, cycle).expect("a plan"))
        }
        Goal::Passing(target, velocity) => {
            to_position(OnlinePlan::passing(start, target, velocity, limits, before, cycle).expect("a plan"))
        }
        Goal::Velocity(velocity) => {
            let plan = RampPlan::new(start, velocity, limits, before, cycle).expect("a plan");
            Plan {
                segments: plan.segments().collect(),
                excess: plan.excess(),
                left: plan.at(scan),
            }
        }
    }
}

fn limits([velocity, acceleration, deceleration, jerk, snap]: [f64; 5]) -> Limits {
    Limits {
        velocity,
        acceleration,
        deceleration,
        jerk,
        snap,
    }
}

/// Lowered limits with a way back inside by a deceleration that lasts seconds to days, after an acceleration
/// thousands of times higher: limits, limits before, cycle, position, velocity, acceleration, jerk, goal.
type Lowered = ([f64; 5], [f64; 5], f64, [f64; 4], Goal);

#[rustfmt::skip]
const LOWERED: &[Lowered] = &[
    ([58.55583926409566, 14690.831342966949, 2.126111839826737, 2.443820207045877e17, 18925137746.990204], [113.53222699044566, 14769.831306842105, 1.4833410686024369, 5.841658540328302e17, 16580186120.57239], 0.00019013236977151774,
        [-304.83459881408754, -75.56671136335329, -12209.771503892312, -9213714.561750151], Goal::Position(-304.83459959365786)),
    ([35.10220671073962, 26185.259442665203, 2.6185259442665205, 12633796.167119473, 295930931049.75574], [76.04871720109547, 23769.215612638774, 2.6185259442665205, 12633796.167119473, 319979905243.48566], 5.215822990785209e-6,
        [-81.87422265507186, 58.30813444029256, 21171.704648993957, -12633796.167119473], Goal::Position(0.5239582837928469)),
    ([0.071573291011485, 0.2222159652604925, 5.020528867274772e-5, 0.8086555062589377, 3.9172221919869834], [0.1034523753985038, 0.399474038311981, 2.526605369518758e-5, 1.7155326257103498, 8.860322084324547], 0.0016873934752230347,
        [-0.1573934928199487, -0.09314449044188247, -0.16063596792240226, 1.4854553747218857], Goal::Position(0.012219071766583621)),
    ([9.641088789547844, 62699.08454951985, 9.95857387916069, 3947663029.79034, 23789259201090.773], [15.88003009779434, 99585.7387916069, 9.95857387916069, 4122324523.122899, 23789259201090.773], 3.0488475888595627e-5,
        [-0.25101266115508697, 3.428022078483973, 44216.51817948434, 1450596511.1200154], Goal::Position(0.0054059804992946546)),
    ([0.0015586575643406178, 16.121488804901308, 0.0016181242130599899, f64::INFINITY, 917526437.535992], [0.0025881179996211983, 13.822367058535498, 0.0018511981023257354, f64::INFINITY, 651809271.1173499], 3.4500693209990206e-7,
        [8.221851990282983e-8, -0.001012548150097548, -10.038115997777915, -18071.277318280663], Goal::Position(9.663544655386886e-8)),
    ([0.4286343254879438, 51.06107273088364, 0.01618102657270388, 1.744536163397989e308, 506223.9296521871], [0.7654590944739816, 51.06107273088364, 0.016106193490807018, 1.6941493418653604e308, 531958.4853372741], 0.0014184058260917815,
        [-0.0010954295045558903, -0.1271277196238197, -31.217461611875898, -3497.092080124178], Goal::Passing(-0.001095428044547703, 0.3669969327843112)),
    ([0.7722896203400018, 1.3159541088276876, 0.00018547945194314003, 0.39572325414738996, 0.1359963185776671], [1.2868435205410482, 1.6658934236412333, 0.00019627675604407853, 0.553636018070509, 0.1744809314252056], 0.0030133115043476134,
        [-165.75634748652405, 0.2921968991637879, 0.333497688445623, 0.164619202730363], Goal::Velocity(-0.60206722134033)),
    ([7.751421386948498e-7, 1.4653009456162813e-7, 7.404190997171857e-12, 1.0538389886650952e-7, 2.328221804869466e-9], [1.8371231986450736e-6, 1.4653009456162813e-7, 1.0970820299800337e-11, 5.7589141976963046e-8, 2.2460786721039056e-9], 0.012585575557946519,
        [-0.0011695393347530073, 4.545518749483457e-7, 8.196790029274535e-8, 1.1760501096041742e-8], Goal::Velocity(-1.080495390071496e-7)),
    ([374.84183122060637, 1151.2445006950754, 0.11512445006950754, 113036.34263450216, 4131457.544243768], [815.6905450794717, 586.6115816167979, 0.053361972393254, 77253.45297209216, 4709967.538836463], 0.002434149885909469,
        [1743.8606346922825, 815.6375143242019, 39.06267834731589, -19182.489254310443], Goal::Velocity(0.0)),
];

/// The rounding residue of the jerk before such a stretch is not held throughout it.
#[test]
fn a_low_deceleration_is_held_without_a_jump_at_its_end() {
    for &(bounds, before, cycle, [position, velocity, acceleration, jerk], goal) in LOWERED {
        let start = Setpoint {
            position,
            velocity,
            acceleration,
            jerk,
            snap: 0.0,
        };
        let plan = plan(&start, goal, &limits(bounds), &limits(before), cycle, 0);
        let fastest = limits(before).velocity;
        let mut velocity = start.velocity;
        for segment in &plan.segments {
            let jump = (segment.velocity - velocity).abs();
            assert!(jump <= 1e-11 * fastest, "a jump of {jump:e} u/s in {plan:?}");
            let Segment {
                duration: t,
                acceleration: a,
                jerk: j,
                snap: s,
                ..
            } = *segment;
            velocity = segment.velocity + t * (a + t * (j / 2.0 + t * s / 6.0));
        }
    }
}

/// Turns in which a hard brake is released down to a low acceleration just at zero velocity: two limits of
/// velocity, the limits of acceleration, deceleration and jerk, cycle, position, velocity, acceleration, first
/// goal, the scan at which it is replaced, and the next goal.
type Turn = ([f64; 2], [f64; 3], f64, [f64; 3], Goal, u64, Goal);

#[rustfmt::skip]
const TURNS: &[Turn] = &[
    ([1206.9255192791004, 1603.3412624705466], [729.8783210391072, 7298783.210391072, 24851632350.48419], 4.2719075679835004e-7, [-2.7899910922402986, 247.00896163311774, 729.878321039107],
        Goal::Position(-2.7906699188579664), 270, Goal::Position(-0.24064646782723007)),
    ([7.275501261947572e29, 7.819562804164977e29], [70.63105221945831, 706310.5221945831, 944881685.1290649], 1.4365018514961258e-6, [0.001708396154853142, -4.124606235467164, -70.63105221945924],
        Goal::Velocity(0.00010394098155943544), 55, Goal::Velocity(-3.261913180911103)),
    ([0.0012455428406459475, 0.0012455428406459475], [1.4557182933552816e-7, 0.00048483570099139826, 9.8550579749594e-5], 0.09490776833416635, [0.7506254304183848, -0.0007550336122020415, -1.455718293355302e-7],
        Goal::Velocity(2.8723326002392336e-9), 54, Goal::Velocity(-0.000886966500252461)),
    ([557.1240716839882, 1343.7289681762763], [128.45839989161092, 1284583.998916109, 89409595.99883643], 1.4225020133899632e-5, [1255.7932467112648, 546.140515722883, 128.4583998916205],
        Goal::Velocity(-0.3689736017223412), 178, Goal::Velocity(1025.7718160112126)),
    ([17.411330974739922, 17.411330974739922], [7.087043827621899, 70870.43827621899, 3055659.464157469], 0.00019758268365610592, [-2.2442374122335456, -0.7890470362055156, -7.087043827621983],
        Goal::Position(-0.017863491588253868), 5, Goal::Velocity(0.0)),
    ([0.10098522973356508, 0.10098522973356508], [0.00041271264762720927, 4.1271264762720925, 1.9680789196381696], 0.008405810451548281, [0.028792836754017986, -0.0020924478326756154, -0.00041271264762720927],
        Goal::Position(0.028792836754017986), 7, Goal::Velocity(0.0)),
    ([5204489003.779796, 6727658557.227742], [5.738799721583158e-6, 0.05738799721583158, 0.013894296716364479], 0.0531607647932004, [-0.5779551068541761, 0.0004932565207417371, 5.738799721583164e-6],
        Goal::Position(-0.5779551068541761), 5, Goal::Velocity(0.0)),
    ([1.0396784027751365e23, 1.6012871079966073e23], [0.10715234217267801, 99.84439294035205, 1856.5535580882895], 0.001081620844113698, [-6.718124894130813, 2.511268244914147, 0.10715234217268232],
        Goal::Position(-6.718124894130813), 68, Goal::Velocity(0.0)),
    ([1319571276924.007, 1319571276924.007], [0.032809063458852684, 49.48907426917047, 1930.9703467998681], 0.0004396273716561388, [-0.0620807824556335, -0.06683551684030561, -0.03280906345885448],
        Goal::Velocity(1.476159161852112e-6), 26, Goal::Velocity(0.0)),
    ([0.08457457717955036, 0.08457457717955036], [0.00023097225066872064, 2.3097225066872062, 8.795178969522354], 0.00036713987731004893, [2.3928994071551424, 0.0007920222227248969, 0.00023097225066875948],
        Goal::Velocity(-2.823313552420861e-7), 30, Goal::Velocity(0.0)),
];

/// In the middle of a release, a stop or a continued turn is not too late for the lower limit.
#[test]
fn a_release_is_down_to_the_lower_limit_when_the_velocity_is_zero() {
    for &([first, next], [up, down, jerk], cycle, [position, velocity, acceleration], goal, scan, then) in
        TURNS
    {
        let bounds = |velocity: f64| limits([velocity, up, down, jerk, f64::INFINITY]);
        let start = Setpoint {
            position,
            velocity,
            acceleration,
            ..Setpoint::default()
        };
        let turn = plan(&start, goal, &bounds(first), &bounds(first), cycle, scan);
        assert_eq!(turn.excess, None, "{turn:?}");
        let rest = plan(&turn.left, then, &bounds(next), &bounds(first), cycle, 0);
        let excess = rest.excess.unwrap_or_default();
        assert_eq!(excess.acceleration, 0.0, "{rest:?} {turn:?}");
    }
}
