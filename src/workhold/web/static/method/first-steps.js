"use strict";
/* Steps 1 to 3: a peg touches, two pegs leave one freedom, and four touch where two curves meet. */
const DEGREE = Math.PI / 180;
/** Most that the part turns either way from where it is held, in radians. */
const MOST_TURN = 35 * DEGREE;
/** So near to a crossing the part falls into place, in degrees. */
const FALLS_IN = 0.4;

/** The box around the outline in some poses, and around more points. */
function boxOfPoses(lesson, poses, more, margin) {
  const outline = pointsOfLoops(lesson.loops);
  const [x0, y0, x1, y1] = boxAround([...poses.flatMap((pose) => outline.map((point) => placed(pose, point))), ...more]);
  return [x0 - margin, y0 - margin, x1 + margin, y1 + margin];
}

/** Numbers from one to another. */
function spread(low, high, count) {
  return Array.from({ length: count }, (_, k) => low + ((high - low) * k) / (count - 1));
}

/** A box of a plot around points, a little larger. */
function plotBox(points, least = 1) {
  const [x0, y0, x1, y1] = boxAround(points);
  const more = Math.max((y1 - y0) * 0.12, least / 2);
  return [x0, y0 - more, x1, y1 + more];
}

/** Step 1: a peg goes round the part. @returns {StepParts} */
function onePeg(lesson) {
  const picture = new Picture("The part, and a peg that touches it", 0.9);
  const radius = lesson.toolkit.peg_radius;
  const ends = [0];
  for (const row of lesson.features) ends.push(ends.at(-1) + featureLength(row));
  const placeAt = (value) => {
    let k = 0;
    while (k < lesson.features.length - 1 && value > ends[k + 1]) k += 1;
    const row = lesson.features[k];
    const point = pointAlong(row, Math.min(value, ends[k + 1]) - ends[k]);
    return { k, row, point, normal: outwardNormal(row, point) };
  };
  return {
    pictures: [picture],
    range: [0, ends.at(-1)],
    by: ends.at(-1) / 200,
    start: (ends[0] + ends[1]) / 2,
    drag: [(point) => {
      const off = lesson.features.map((row) => {
        const [x, y] = pointAlong(row, nearestAlong(row, point));
        return Math.hypot(x - point[0], y - point[1]);
      });
      const k = off.indexOf(Math.min(...off));
      return ends[k] + nearestAlong(lesson.features[k], point);
    }],
    draw(value) {
      const { point, normal } = placeAt(value);
      picture.fit(boxOfPoses(lesson, [{ theta: 0, x: 0, y: 0 }], [], 3.2 * radius));
      picture.part(lesson);
      for (const row of lesson.features) {
        const length = featureLength(row);
        picture.curve(spread(0, length, row[IS_ARC] ? 40 : 2).map((s) => pointAlong(row, s)), "locus");
      }
      const contact = [point[0] - radius * normal[0], point[1] - radius * normal[1]];
      picture.line([contact[0] - 400 * normal[0], contact[1] - 400 * normal[1]], [contact[0] + 400 * normal[0], contact[1] + 400 * normal[1]], "action");
      picture.peg(point, radius, 1, "grab");
      picture.dot(point, 22, "grab reach");
      picture.arrow(contact, [-normal[0], -normal[1]], 34, "push", "tail");
      for (const side of [1, -1]) picture.arrow(contact, [-side * normal[1], side * normal[0]], 30, "free", "tail");
    },
    say(value) {
      const { k, point, normal } = placeAt(value);
      const face = lesson.faces[k];
      return {
        words: `The peg stands at x ${shown(point[0])}, y ${shown(point[1])} mm and touches face ${face}. Freedoms left: 2.`,
        numbers: { feature: k, face, point, normal },
      };
    },
  };
}

/** Draws jaws, the part on its two left pegs, and what is common to steps 2 and 3. */
function drawLeftJaw(picture, lesson, fixture, pose) {
  const radius = lesson.toolkit.peg_radius;
  const [pitchX, pitchY] = lesson.toolkit.pitch;
  const pegs = fixture.pegs.slice(0, 2);
  const columns = [...new Set(pegs.map((peg) => peg[2]))].sort((a, b) => a - b);
  const [x0, x1] = [columns[0] - 0.5 * pitchX, columns.at(-1) + 0.5 * pitchX];
  drawPlate(picture, x0, x1, "standing");
  picture.holes(columns, pegs[0][3], pitchY, radius, "hole");
  picture.part(lesson, pose);
}

/** The plate of a jaw, from top to bottom of the picture. */
function drawPlate(picture, x0, x1, kind) {
  const [left, top] = picture.at([x0, picture.box[3]]);
  const [right, foot] = picture.at([x1, picture.box[1]]);
  picture.add(svgNode("rect", { x: left, y: top, width: right - left, height: foot - top, rx: 4, class: `plate ${kind}` }));
}

/** Step 2: the part slides on two pegs. @returns {StepParts} */
function twoPegs(lesson) {
  const fixture = lesson.fixtures[0];
  const picture = new Picture("The part on two pegs of the left jaw, and the point it turns about", 1);
  const plot = new Picture("The height of the two pegs on the part, over the part's turn", 0.9, 320);
  const range = commonRange(fixture, MOST_TURN, [fixture.chords[0]]).map((end) => end / DEGREE);
  const poseAt = (value) => poseOnLeft(lesson, fixture, value * DEGREE);
  const chordOf = (value) => chordAt(lesson.features, fixture.chords[0], -value * DEGREE);
  const margin = 2 * lesson.toolkit.peg_radius;
  const box = boxOfPoses(lesson, spread(...range, 9).map(poseAt), fixture.pegs.slice(0, 2).map((peg) => [peg[2], peg[3]]), margin);
  const curve = spread(...range, 121).map((value) => [value, chordOf(value).height]);
  return {
    pictures: [picture, plot],
    range,
    by: (range[1] - range[0]) / 100,
    start: range[0] + 0.3 * (range[1] - range[0]),
    grab: (point, value) => broughtBack(poseAt(value), point),
    drag: [
      (point, grabbed) => nearestValue(range, (value) => {
        const [x, y] = placed(poseAt(value), grabbed);
        return Math.hypot(x - point[0], y - point[1]);
      }),
      (point) => point[0],
    ],
    draw(value) {
      const [pose, chord] = [poseAt(value), chordOf(value)];
      picture.fit(box);
      drawLeftJaw(picture, lesson, fixture, pose);
      picture.svg.querySelector(".part").classList.add("grab");
      const centre = placed(pose, chord.centre);
      const pegs = pegsOfChord(fixture, 0);
      pegs.forEach((peg, k) => {
        const normal = turned(chord.normals[k], pose.theta);
        const far = 2000;
        picture.line([peg[2] - far * normal[0], peg[3] - far * normal[1]], [peg[2] + far * normal[0], peg[3] + far * normal[1]], "action");
      });
      picture.curve(spread(...range, 61).map((v) => placed(poseAt(v), chordOf(v).centre)).filter((p) => Math.hypot(...p) < 1e4), "trace");
      for (const [k, peg] of fixture.pegs.slice(0, 2).entries()) picture.peg([peg[2], peg[3]], lesson.toolkit.peg_radius, k + 1);
      const ends = pegs.map((peg) => [peg[2], peg[3]]);
      const gap = lesson.toolkit.peg_radius / fixture.chords[0][4];
      picture.line(...[gap, 1 - gap].map((share) => [0, 1].map((axis) => ends[0][axis] + share * (ends[1][axis] - ends[0][axis]))), "chord");
      picture.dot(centre, 5, "centre");
      const inside = centre[0] > box[0] && centre[0] < box[2] && centre[1] > box[1] && centre[1] < box[3];
      if (inside) picture.words(centre, "instant centre", "name middle", [0, -11]);
      plot.fit(plotBox(curve), true);
      plot.axes("turn of the part", "height h, mm", "°");
      plot.curve(curve, "curve left");
      plot.dot([value, chord.height], 7, "mark");
    },
    say(value) {
      const chord = chordOf(value);
      const centre = placed(poseAt(value), chord.centre);
      return {
        words: `Turned to ${shown(value, 1)}°: height ${shown(chord.height)} mm. At this moment the part turns about x ${shown(centre[0], 1)}, y ${shown(centre[1], 1)} mm from hole L-A1.`,
        numbers: { theta: value, height: chord.height, centre, tail: chord.tail, head: chord.head },
      };
    },
  };
}

/** Fixtures of the list whose two chords are those of the shown one. */
function onSameCurves(lesson, fixture) {
  const same = (one, other) => [0, 1, 3, 4, 5].every((k) => Math.abs(one[k] - other[k]) < 1e-9);
  return lesson.fixtures.filter((other) => other.chords.every((chord, pair) => same(chord, fixture.chords[pair])));
}

/** Step 3: four pegs touch where the curves of both pairs meet. @returns {StepParts} */
function crossing(lesson) {
  const fixture = lesson.fixtures[0];
  const picture = new Picture("The part on its left pegs, and where the right pegs would touch it", 1);
  const plot = new Picture("The heights of both pairs on the part, over its turn; left ones also moved by whole rows", 0.9, 320);
  const range = commonRange(fixture, MOST_TURN).map((end) => end / DEGREE);
  const radius = lesson.toolkit.peg_radius;
  const [pitchX, pitchY] = lesson.toolkit.pitch;
  const roots = onSameCurves(lesson, fixture).map((one) => one.pose[0] / DEGREE).filter((root) => root >= range[0] && root <= range[1]);
  const at = (value) => rightPair(lesson, fixture, value * DEGREE);
  const samples = spread(...range, 121).map((value) => [value, at(value)]);
  const left = pegsOfChord(fixture, 0)[0];
  const right = pegsOfChord(fixture, 1)[0];
  const heights = (pair, value) => chordAt(lesson.features, fixture.chords[pair], -value * DEGREE).height;
  const rightCurve = spread(...range, 121).map((value) => [value, heights(1, value)]);
  const leftCurve = rightCurve.map(([value]) => [value, heights(0, value) + right[3] - left[3]]);
  const every = samples.flatMap(([, found]) => [found.tail, found.head]);
  const box = boxOfPoses(lesson, spread(...range, 9).map((value) => at(value).pose), [...every, ...fixture.pegs.map((peg) => [peg[2], peg[3]])], 2 * radius);
  return {
    pictures: [picture, plot],
    range,
    by: (range[1] - range[0]) / 100,
    start: range[0] + 0.2 * (range[1] - range[0]),
    settle: (value) => roots.find((root) => Math.abs(root - value) < Math.min(FALLS_IN, (range[1] - range[0]) / 80)) ?? value,
    grab: (point, value) => broughtBack(at(value).pose, point),
    drag: [
      (point, grabbed) => nearestValue(range, (value) => {
        const [x, y] = placed(at(value).pose, grabbed);
        return Math.hypot(x - point[0], y - point[1]);
      }),
      (point) => point[0],
    ],
    draw(value) {
      const { pose, tail, head, rowsOff } = at(value);
      const fits = Math.abs(rowsOff - Math.round(rowsOff)) < 1e-6;
      picture.fit(box);
      const columns = [tail[0], head[0]].sort((a, b) => a - b).filter((x, k, all) => !k || x - all[k - 1] > 1e-6);
      drawPlate(picture, columns[0] - 0.5 * pitchX, columns.at(-1) + 0.5 * pitchX, "moving");
      picture.holes(columns, right[3], pitchY, radius, "hole");
      drawLeftJaw(picture, lesson, fixture, pose);
      picture.svg.querySelector(".part").classList.add("grab");
      for (const [k, peg] of fixture.pegs.slice(0, 2).entries()) picture.peg([peg[2], peg[3]], radius, k + 1);
      const pair = fixture.chords[1][2] ? [head, tail] : [tail, head];
      if (!fits) for (const point of pair) {
        const hole = [point[0], point[1] - (rowsOff - Math.round(rowsOff)) * pitchY];
        picture.disc(hole, radius, "hole wanted");
        picture.line(point, hole, "missed");
      }
      pair.forEach((point, k) => picture.peg(point, radius, k + 3, fits ? "other" : "other unset"));
      const rows = plotBox(rightCurve, pitchY);
      plot.fit(rows, true);
      plot.axes("turn of the part", "height h, mm", "°");
      const lowest = Math.floor((rows[1] - Math.max(...leftCurve.map((p) => p[1]))) / pitchY);
      const highest = Math.ceil((rows[3] - Math.min(...leftCurve.map((p) => p[1]))) / pitchY);
      for (let k = lowest; k <= highest; k += 1) {
        plot.curve(leftCurve.map(([x, y]) => [x, y + k * pitchY]).filter(([, y]) => y >= rows[1] && y <= rows[3]), `curve left${k ? " copy" : ""}`);
      }
      plot.curve(rightCurve, "curve right");
      for (const root of roots) plot.dot([root, heights(1, root)], 9, "ring");
      plot.dot([value, heights(1, value)], 6, fits ? "mark good" : "mark");
    },
    say(value) {
      const { rowsOff, pose } = at(value);
      const miss = (rowsOff - Math.round(rowsOff)) * pitchY;
      const fits = Math.abs(miss) < 1e-5;
      const words = fits
        ? `All four pegs touch, at ${shown(value, 3)}°: a crossing.`
        : `At ${shown(value, 1)}° pegs 3 and 4 miss their holes by ${shown(Math.abs(miss))} mm.`;
      return { words, numbers: { theta: value, miss, fits, pose: [pose.x, pose.y], heights: [heights(0, value), heights(1, value)], roots } };
    },
  };
}
