// What charts need of statistics.

/** The value below which a share of some sorted values lies. */
export function quantile(sorted, share) {
  const rank = share * (sorted.length - 1);
  const below = Math.floor(rank);
  const above = Math.ceil(rank);
  return sorted[below] + (sorted[above] - sorted[below]) * (rank - below);
}

/** The quantile of the standard normal distribution (Acklam's rational approximation, to 1e-9 of its value). */
export function normalQuantile(p) {
  const a = [-39.69683028665376, 220.9460984245205, -275.9285104469687, 138.357751867269, -30.66479806614716, 2.506628277459239];
  const b = [-54.47609879822406, 161.5858368580409, -155.6989798598866, 66.80131188771972, -13.28068155288572];
  const c = [-0.007784894002430293, -0.3223964580411365, -2.400758277161838, -2.549732539343734, 4.374664141464968, 2.938163982698783];
  const d = [0.007784695709041462, 0.3224671290700398, 2.445134137142996, 3.754408661907416];
  const polynomial = (factors, x) => factors.reduce((sum, factor) => sum * x + factor, 0);
  if (p < 0.02425) {
    const q = Math.sqrt(-2 * Math.log(p));
    return polynomial(c, q) / (polynomial(d, q) * q + 1);
  }
  if (p > 1 - 0.02425) return -normalQuantile(1 - p);
  const q = p - 0.5;
  return (polynomial(a, q * q) * q) / (polynomial(b, q * q) * q * q + 1);
}

/**
 * A smooth curve through points sorted by x: straight lines fitted locally, the nearer points counting more (cleveland1979), at `count`
 * places from the first x to the last. About thirty points make each value, at most a quarter of the range wide. `spreads` are standard
 * deviations of the values, by the scatter of the points about the curve.
 */
export function smooth(xs, ys, count = 150) {
  const points = xs.map((x, k) => [x, ys[k]]).filter(([, y]) => y !== null);
  if (points.length < 8) return null;
  const [first, last] = [points[0][0], points[points.length - 1][0]];
  if (!(last > first)) return null;
  const share = Math.min(0.25, Math.max(0.05, 30 / points.length));
  // Wide enough for a share of the range, and for at least eight points.
  const places = Array.from({ length: count }, (_, k) => first + ((last - first) * k) / (count - 1));
  const found = places.map((place) => {
    const width = Math.max((share * (last - first)) / 2, 1.01 * distanceOfNearest(points, place, 8));
    return local(points, place, width);
  });
  const values = found.map(([value]) => value);
  const scatter = Math.sqrt(points.reduce((sum, [x, y]) => sum + (y - interpolate({ places, values }, x)) ** 2, 0) / Math.max(points.length - 2 / share, 1));
  return { places, values, spreads: found.map(([, gain]) => scatter * gain) };
}

/** Within which distance of a place `count` points lie. */
function distanceOfNearest(points, place, count) {
  const after = points.findIndex(([x]) => x >= place);
  const middle = after < 0 ? points.length : after;
  let nearest = Infinity;
  for (let k = Math.max(middle - count, 0); k + count <= Math.min(middle + count, points.length); k++) {
    nearest = Math.min(nearest, Math.max(place - points[k][0], points[k + count - 1][0] - place));
  }
  return nearest;
}

/** The value of the line at a place, and its standard deviation over that of a point. */
function local(points, place, width) {
  let [s, sx, sy, sxx, sxy] = [0, 0, 0, 0, 0];
  const near = [];
  for (const [x, y] of points) {
    const d = (x - place) / width;
    if (Math.abs(d) >= 1) continue;
    const weight = (1 - Math.abs(d) ** 3) ** 3;
    near.push([d, weight]);
    s += weight;
    sx += weight * d;
    sy += weight * y;
    sxx += weight * d * d;
    sxy += weight * d * y;
  }
  const determinant = s * sxx - sx * sx;
  const isLine = determinant > 1e-9 * s * s;
  const share = ([d, weight]) => (isLine ? (weight * (sxx - sx * d)) / determinant : weight / s);
  const gain = Math.sqrt(near.reduce((sum, point) => sum + share(point) ** 2, 0));
  return [isLine ? (sxx * sy - sx * sxy) / determinant : sy / s, gain];
}

/** The value of a curve at `x`, by straight lines between its places. */
export function interpolate({ places, values }, x) {
  const step = (places[places.length - 1] - places[0]) / (places.length - 1);
  const k = Math.min(Math.max(Math.floor((x - places[0]) / step), 0), places.length - 2);
  const share = (x - places[k]) / step;
  return values[k] + (values[k + 1] - values[k]) * share;
}
