// Parts of the workspace that the robot could reach but that were not measured.
import { CALIBRATED, add, configure } from "./kinematics.js";

export const REACH_POINTS = 2500;

/** Numbers from 0 to 1 that are the same each time the page is opened (mulberry32). */
function generator(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let value = Math.imul(state ^ (state >>> 15), 1 | state);
    value = (value + Math.imul(value ^ (value >>> 7), 61 | value)) ^ value;
    return ((value ^ (value >>> 14)) >>> 0) / 4294967296;
  };
}

/** Positions of moving targets in random configurations within the limits, without those near to measured ones. */
export function unsampled(data, size) {
  const next = generator(1);
  const cell = size / 7;
  const key = (place) => place.map((value) => Math.floor(value / cell)).join(",");
  const sampled = new Set();
  for (const place of data.rows.reached) {
    for (const dx of [-1, 0, 1]) for (const dy of [-1, 0, 1]) for (const dz of [-1, 0, 1]) sampled.add(key(add(place, [dx * cell, dy * cell, dz * cell])));
  }
  const ranges = data.readings.map((_, k) => {
    const joint = data.joints.find((it) => it.reading === k);
    const limits = joint.limits && joint.limits[1] - joint.limits[0] < 100 ? joint.limits : joint.sampled ?? [0, 0];
    return limits.map((limit) => (limit - joint.offset) / joint.multiplier);
  });
  const places = Array.from({ length: REACH_POINTS }, (_, k) => {
    const readings = ranges.map(([a, b]) => a + (b - a) * next());
    return configure(data, readings, CALIBRATED).at(data.reaching[k % data.reaching.length]).t;
  });
  return places.filter((place) => !sampled.has(key(place)));
}
