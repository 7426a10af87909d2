// View points of the picture.
import { Vector3 } from "three";

/** Views by name: the direction to the eye. */
export const DIRECTIONS = { oblique: [1, -1.25, 0.75], front: [0, -1.7, 0.02], side: [1.7, 0, 0.02], top: [0.001, -0.02, 1.7] };
/** Ratio of the picture's height to that of its contents. */
const ROOM = 1.15;
/** Share of the measured positions, those nearest to their middle, that are shown with the robot. */
const MIDDLE = 0.5;

/** The positions nearest to the middle of all: those that a picture of the robot has to show. */
export function middlePlaces(places) {
  const middle = [0, 1, 2].map((k) => places.reduce((sum, place) => sum + place[k], 0) / Math.max(places.length, 1));
  const far = (place) => Math.hypot(...place.map((value, k) => value - middle[k]));
  return [...places].sort((a, b) => far(a) - far(b)).slice(0, Math.ceil(MIDDLE * places.length));
}

/** Distance and centre from which all positions are seen from a direction, with equal room on opposite sides. */
export function framed(places, direction, { half, aspect }) {
  const right = new Vector3(0, 0, 1).cross(direction).normalize();
  const up = direction.clone().cross(right);
  const centre = new Vector3();
  const ats = places.map((place) => new Vector3(...place));
  for (const at of ats) centre.addScaledVector(at, 1 / ats.length);
  for (const at of ats) at.sub(centre);
  const distance = () => ROOM * Math.max(...ats.map((at) => at.dot(direction) + Math.max(Math.abs(at.dot(up)), Math.abs(at.dot(right)) * aspect) / half));
  for (const side of [right, up, right, up, right, up]) {
    const from = distance();
    const parts = ats.map((at) => at.dot(side) / (from - at.dot(direction)));
    const shift = side.clone().multiplyScalar((from * (Math.min(...parts) + Math.max(...parts))) / 2);
    centre.add(shift);
    for (const at of ats) at.sub(shift);
  }
  return { centre, distance: distance() };
}
