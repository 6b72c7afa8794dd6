"use strict";
/*
 * Chords of two pegs in closed form, as workhold.kernels.chord.evaluation has them. Nothing here touches the page.
 *
 * A feature is a row [is arc, x, y, axis x, axis y, half extent, radius, sign]: the middle of a line and the unit
 * vector along it, or the centre of an arc and the unit vector to its middle. Points are [x, y] in mm, angles are in
 * radians. The part sees the pegs turned by psi = -theta.
 */
const [IS_ARC, X, Y, AXIS_X, AXIS_Y, HALF, RADIUS, SIGN] = [0, 1, 2, 3, 4, 5, 6, 7];

/** @typedef {{theta: number, x: number, y: number}} Pose the map of a part's point q to R(theta) q + (x, y) */

/** A point turned by an angle. @param {number[]} point @param {number} angle */
function turned([x, y], angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [c * x - s * y, s * x + c * y];
}

/** A point of the part in the vise. @param {Pose} pose @param {number[]} point */
function placed(pose, point) {
  const [x, y] = turned(point, pose.theta);
  return [x + pose.x, y + pose.y];
}

/** A point of the vise in the part. @param {Pose} pose @param {number[]} point */
function broughtBack(pose, [x, y]) {
  return turned([x - pose.x, y - pose.y], -pose.theta);
}

/** The unit vector towards a contact: a line's normal, or from an arc's centre. */
function contactDirection(row, [x, y]) {
  if (!row[IS_ARC]) return [row[AXIS_Y], -row[AXIS_X]];
  return [(x - row[X]) / row[RADIUS], (y - row[Y]) / row[RADIUS]];
}

/** The outward unit normal of a feature at a point on it. */
function outwardNormal(row, point) {
  return contactDirection(row, point).map((part) => part * row[SIGN]);
}

/** The distance of a point from the line or circle of a feature, outward positive. */
function distanceOutside(row, [x, y]) {
  if (!row[IS_ARC]) return (x - row[X]) * row[AXIS_Y] - (y - row[Y]) * row[AXIS_X];
  return row[SIGN] * (Math.hypot(x - row[X], y - row[Y]) - row[RADIUS]);
}

/** The length of a feature, in mm. */
function featureLength(row) {
  return 2 * row[HALF] * (row[IS_ARC] ? row[RADIUS] : 1);
}

/** The point of a feature at a distance from its first end; material lies on the left of a way along the outline. */
function pointAlong(row, distance) {
  if (!row[IS_ARC]) {
    const s = distance - row[HALF];
    return [row[X] + s * row[AXIS_X], row[Y] + s * row[AXIS_Y]];
  }
  const angle = row[SIGN] * (distance / row[RADIUS] - row[HALF]);
  const [x, y] = turned([row[AXIS_X], row[AXIS_Y]], angle);
  return [row[X] + row[RADIUS] * x, row[Y] + row[RADIUS] * y];
}

/** How far from a feature's first end its point nearest to another point is, in mm. */
function nearestAlong(row, [x, y]) {
  const [dx, dy] = [x - row[X], y - row[Y]];
  const along = dx * row[AXIS_X] + dy * row[AXIS_Y];
  const across = dy * row[AXIS_X] - dx * row[AXIS_Y];
  const s = row[IS_ARC] ? row[SIGN] * Math.atan2(across, along) : along;
  const inside = Math.min(row[HALF], Math.max(-row[HALF], s));
  return (inside + row[HALF]) * (row[IS_ARC] ? row[RADIUS] : 1);
}

/** Tail on a line, head on an arc; its branch is that of the program. */
function lineToArc(a, b, [wx, wy], branch) {
  const [nx, ny] = [a[AXIS_Y], -a[AXIS_X]];
  const across = nx * (a[X] + wx - b[X]) + ny * (a[Y] + wy - b[Y]);
  const half = branch * Math.sqrt(Math.max((b[RADIUS] - across) * (b[RADIUS] + across), 0));
  return [b[X] + across * nx + half * a[AXIS_X] - wx, b[Y] + across * ny + half * a[AXIS_Y] - wy];
}

/** Tail and head on arcs: the tail lies on one circle, and on the other moved back by the chord. */
function arcToArc(a, b, [wx, wy], branch) {
  const [gx, gy] = [b[X] - a[X] - wx, b[Y] - a[Y] - wy];
  const gap = Math.hypot(gx, gy);
  const along = (gap + ((a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS])) / gap) / 2;
  const half = branch * Math.sqrt(Math.max((a[RADIUS] - along) * (a[RADIUS] + along), 0));
  return [a[X] + (along * gx - half * gy) / gap, a[Y] + (along * gy + half * gx) / gap];
}

/** The tail of a chord w from feature a to feature b. */
function chordTail(a, b, w, branch) {
  if (a[IS_ARC] && b[IS_ARC]) return arcToArc(a, b, w, branch);
  if (b[IS_ARC]) return lineToArc(a, b, w, branch);
  if (a[IS_ARC]) {
    const head = lineToArc(b, a, [-w[0], -w[1]], branch);
    return [head[0] - w[0], head[1] - w[1]];
  }
  const [nx, ny] = [b[AXIS_Y], -b[AXIS_X]];
  const s = (nx * (b[X] - a[X] - w[0]) + ny * (b[Y] - a[Y] - w[1])) / (nx * a[AXIS_X] + ny * a[AXIS_Y]);
  return [a[X] + s * a[AXIS_X], a[Y] + s * a[AXIS_Y]];
}

/**
 * A chord of a lesson, [tail, head, swapped, shift, length, branch, low, high], at an orientation.
 * The instant centre is where the lines of push through both contacts meet; h is the tail's height over the part.
 * @param {number[][]} features
 * @param {number[]} chord
 * @param {number} psi
 */
function chordAt(features, [tailNumber, headNumber, , shift, length, branch], psi) {
  const [a, b] = [features[tailNumber], features[headNumber]];
  const w = [length * Math.cos(psi + shift), length * Math.sin(psi + shift)];
  const tail = chordTail(a, b, w, branch);
  const head = [tail[0] + w[0], tail[1] + w[1]];
  const [one, other] = [contactDirection(a, tail), contactDirection(b, head)];
  const way = (w[0] * other[1] - w[1] * other[0]) / (one[0] * other[1] - one[1] * other[0]);
  return {
    tail,
    head,
    normals: [outwardNormal(a, tail), outwardNormal(b, head)],
    centre: [tail[0] + way * one[0], tail[1] + way * one[1]],
    height: Math.cos(psi) * tail[1] - Math.sin(psi) * tail[0],
  };
}

/** The pegs of a pair in the order of its chord: the tail first. @param {any} fixture @param {number} pair 0 or 1 */
function pegsOfChord(fixture, pair) {
  const pegs = fixture.pegs.slice(2 * pair, 2 * pair + 2);
  return fixture.chords[pair][2] ? pegs.reverse() : pegs;
}

/** The pose at an orientation at which the left pair of a fixture touches with its pegs in their holes. */
function poseOnLeft(lesson, fixture, theta) {
  const { tail } = chordAt(lesson.features, fixture.chords[0], -theta);
  const [, , x, y] = pegsOfChord(fixture, 0)[0];
  const [ux, uy] = turned(tail, theta);
  return { theta, x: x - ux, y: y - uy };
}

/** The orientations theta, in radians, at which both pairs of a fixture can touch, at most some way from it. */
function commonRange(fixture, most = Infinity, chords = fixture.chords) {
  const theta = fixture.pose[0];
  const low = Math.max(...chords.map((chord) => -chord[7]), theta - most);
  const high = Math.min(...chords.map((chord) => -chord[6]), theta + most);
  return [low, high];
}

/**
 * Where the right pair touches at an orientation: its tail and head in the vise, and how many rows its tail is above
 * the hole that the fixture gives it.
 */
function rightPair(lesson, fixture, theta) {
  const pose = poseOnLeft(lesson, fixture, theta);
  const chord = chordAt(lesson.features, fixture.chords[1], -theta);
  const [tail, head] = [placed(pose, chord.tail), placed(pose, chord.head)];
  const rowsOff = (tail[1] - pegsOfChord(fixture, 1)[0][3]) / lesson.toolkit.pitch[1];
  return { pose, tail, head, rowsOff };
}

/** Small turns about a point: the speed of each contact towards its peg, in mm for each radian turned to the left. */
function armsAbout(lesson, fixture, point) {
  const pose = { theta: fixture.pose[0], x: fixture.pose[1], y: fixture.pose[2] };
  return contactsOf(lesson, fixture).map(({ peg, normal }) => {
    const [nx, ny] = turned(normal, pose.theta);
    return nx * (point[1] - peg[1]) + ny * (peg[0] - point[0]);
  });
}

/** The four pegs of a fixture in the vise, in its order, with the features and the outward normals in the part. */
function contactsOf(lesson, fixture) {
  return [0, 1].flatMap((pair) => {
    const [tail, head, swapped] = fixture.chords[pair];
    const state = chordAt(lesson.features, fixture.chords[pair], -fixture.pose[0]);
    const found = pegsOfChord(fixture, pair).map((peg, k) => ({
      peg: [peg[2], peg[3]],
      force: peg[5],
      feature: k ? head : tail,
      normal: state.normals[k],
    }));
    return swapped ? found.reverse() : found;
  });
}

/** Solves a square system of linear equations, by elimination with pivots. @param {number[][]} rows [..., right side] */
function solved(rows) {
  const size = rows.length;
  const m = rows.map((row) => [...row]);
  for (let k = 0; k < size; k += 1) {
    const pivot = m.slice(k).reduce((best, row, i) => (Math.abs(row[k]) > Math.abs(m[best][k]) ? i + k : best), k);
    [m[k], m[pivot]] = [m[pivot], m[k]];
    for (let i = 0; i < size; i += 1) {
      if (i === k) continue;
      const factor = m[i][k] / m[k][k];
      for (let j = k; j <= size; j += 1) m[i][j] -= factor * m[k][j];
    }
  }
  return m.map((row, k) => row[size] / row[k]);
}

/**
 * The pose that leaves all four pegs equally far from the faces they touch, with the right jaw opened by some mm more:
 * Newton's method on the four distances, from the pose of the fixture on as the jaw opens. Null where it does not settle.
 */
function roomyPose(lesson, fixture, opened) {
  const contacts = contactsOf(lesson, fixture);
  const pose = { theta: fixture.pose[0], x: fixture.pose[1], y: fixture.pose[2] };
  const distances = (moved) => contacts.map(({ peg, feature }, k) => {
    const point = broughtBack(pose, [peg[0] + (k < 2 ? 0 : moved), peg[1]]);
    const row = lesson.features[feature];
    return { point, normal: outwardNormal(row, point), gap: distanceOutside(row, point) };
  });
  let room = 0;
  for (let k = 0; k < 24; k += 1) {
    const rows = distances(opened * Math.min(1, (k + 1) / 8)).map(({ point, normal, gap }) => {
      const [nx, ny] = turned(normal, pose.theta);
      return [normal[0] * point[1] - normal[1] * point[0], -nx, -ny, -1, room - gap];
    });
    const [turn, x, y, more] = solved(rows);
    pose.theta += turn;
    pose.x += x;
    pose.y += y;
    room += more;
  }
  const gaps = distances(opened).map((one) => one.gap);
  const settled = gaps.every((gap) => Math.abs(gap - gaps[0]) < 1e-9) && Math.abs(pose.theta - fixture.pose[0]) < 0.6;
  return settled ? { pose, gaps } : null;
}

/** Where half a turn of sampled orientations begins, in degrees: nothing special lies there. */
const FIRST_SAMPLE = 0.7320508075688772;

/**
 * Whether a plain program that tries a number of orientations over half a turn would see a fixture: its crossing must
 * lie between two neighbours at which both chords exist, and the difference of heights must change its sign there.
 */
function isSampled(lesson, fixture, count) {
  const pitch = Math.PI / count;
  const first = (FIRST_SAMPLE * Math.PI) / 180;
  const before = first + pitch * Math.floor((fixture.pose[0] - first) / pitch);
  const [low, high] = commonRange(fixture);
  if (before < low || before + pitch > high) return false;
  const [one, other] = [before, before + pitch].map((theta) => rightPair(lesson, fixture, theta).rowsOff);
  return one * other <= 0;
}
