// Scripts whose reports are hard on a page.

// A pulse of one scan in the middle of moves that never come by the same place twice, so that nothing of the trace repeats.
export function longScript(scans) {
  const distances = [41.3, -40.9, 17.17, -17.03];
  const name = (at) => `move${at + 1}`;
  return JSON.stringify({
    standstill: 1,
    title: `${scans} scans back and forth`,
    cycle: 'T#1ms',
    scans,
    axes: { X: { unit: 'mm', limits: { velocity: 400, acceleration: 3000, jerk: 60000, snap: 2000000 }, state: 'Standstill' } },
    inputs: { GO: false, PULSE: false },
    blocks: [
      ...distances.map((distance, at) => ({
        name: name(at),
        type: 'MC_MoveAdditive',
        pins: {
          Axis: 'X', Distance: distance, Velocity: 100 + 17 * at,
          Execute: at === 0 ? { from: 'GO' } : { from: `${name(at - 1)}.Done` },
        },
      })),
      { name: 'where', type: 'MC_ReadActualPosition', pins: { Axis: 'X', Enable: true } },
    ],
    steps: [
      { at: 1, set: { GO: true } },
      { when: { 'move4.Done': true }, every: true, set: { GO: false } },
      { when: { 'move4.Done': true }, every: true, after: 7, set: { GO: true } },
      { at: scans / 2, set: { PULSE: true } },
      { at: scans / 2 + 1, set: { PULSE: false } },
    ],
    expect: [{ within_limits: 'X', factor: 1.000001 }],
  });
}

// Texts that would be markup, a script's end or a request if anything took them for it.
export function nastyScript() {
  return JSON.stringify({
    standstill: 1,
    title: '<img src=x onerror="alert(1)"></title></script><script>alert(2)</script><!-- &amp; ${x} \\u003c',
    covers: ['</script><iframe src="https://example.invalid/">'],
    cycle: 'T#10ms',
    scans: 90,
    parameters: { v: 10 },
    axes: { X: { unit: '<b data-nasty>', limits: { velocity: 20, acceleration: 100 }, state: 'Standstill' } },
    inputs: { GO: false },
    blocks: [{
      name: 'move',
      type: 'MC_MoveAbsolute',
      pins: { Axis: 'X', Execute: { from: 'GO' }, Position: 1, Velocity: { param: 'v' } },
    }],
    steps: [{ at: 1, set: { GO: true } }],
    expect: [{ at: 5, that: { 'move.Done': true } }, { never: { 'move.Error': true } }],
  });
}
