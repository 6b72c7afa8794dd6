"use strict";
/* Steps 4 to 6: the jaw closes, every motion is stopped, and no fixture is lost between samples. */

/** The pose in which a fixture holds the part. */
function heldPose(fixture) {
  const [theta, x, y] = fixture.pose;
  return { theta, x, y };
}

/** Where the pegs and the part of the shown fixture are, with room around. */
function heldBox(lesson, fixture, margin, more = []) {
  return boxOfPoses(lesson, [heldPose(fixture)], [...fixture.pegs.map((peg) => [peg[2], peg[3]]), ...more], margin);
}

/** The lengths of arrows for forces, in pixels: in proportion, none too short to be seen. */
function arrowLengths(forces) {
  const most = Math.max(...forces);
  return forces.map((force) => 14 + (40 * force) / most);
}

/** Both jaws and the part, the right jaw moved to the right. */
function drawHeld(picture, lesson, fixture, moved = 0, pose = heldPose(fixture)) {
  const [pitchX, pitchY] = lesson.toolkit.pitch;
  const radius = lesson.toolkit.peg_radius;
  const columns = [...new Set(fixture.pegs.slice(2).map((peg) => peg[2] + moved))].sort((a, b) => a - b);
  drawPlate(picture, columns[0] - 0.5 * pitchX, columns.at(-1) + 0.5 * pitchX, "moving");
  picture.holes(columns, fixture.pegs[2][3], pitchY, radius, "hole sliding");
  drawLeftJaw(picture, lesson, fixture, pose);
}

/** Step 4: the right jaw closes. @returns {StepParts} */
function closing(lesson) {
  const fixture = lesson.fixtures[0];
  const picture = new Picture("The part between both jaws; the right one slides", 0.9);
  const [pitchX, pitchY] = lesson.toolkit.pitch;
  const radius = lesson.toolkit.peg_radius;
  let most = Math.max(0.6 * pitchX, 2 * radius);
  while (!spread(0, most, 13).every((opened) => roomyPose(lesson, fixture, opened))) most *= 0.7;
  const contacts = contactsOf(lesson, fixture);
  const at = (value) => roomyPose(lesson, fixture, value);
  const box = heldBox(lesson, fixture, 2 * radius, [[Math.max(...fixture.pegs.map((peg) => peg[2])) + most + 0.5 * pitchX, fixture.pegs[2][3]]]);
  return {
    pictures: [picture],
    range: [0, most],
    by: most / 50,
    start: 0.6 * most,
    settle: (value) => (value < most / 60 ? 0 : value),
    grab: (point, value) => point[0] - value,
    drag: [(point, grabbed) => point[0] - grabbed],
    draw(value) {
      const { pose } = at(value);
      picture.fit(box);
      drawHeld(picture, lesson, fixture, value, pose);
      for (const node of picture.svg.querySelectorAll(".moving, .sliding")) node.classList.add("grab");
      const lengths = arrowLengths(contacts.map((one) => one.force));
      contacts.forEach(({ peg, normal }, k) => {
        const moved = k < 2 ? 0 : value;
        picture.peg([peg[0] + moved, peg[1]], radius, k + 1, k < 2 ? "" : "other grab");
        if (value === 0) {
          const [nx, ny] = turned(normal, pose.theta);
          picture.arrow([peg[0] - radius * nx, peg[1] - radius * ny], [-nx, -ny], lengths[k], "push", "tail");
        }
      });
      const high = box[3] - 0.2 * pitchY;
      const x = Math.max(...fixture.pegs.map((peg) => peg[2])) + value;
      picture.arrow([x, high], [-1, 0], 40, "jaw", "tail");
    },
    say(value) {
      const { pose, gaps } = at(value);
      const opening = fixture.opening + value;
      const words = value === 0
        ? `Opening ${shown(opening, 3)} mm, closed. For each newton of the jaw the pegs push with ${contacts.map((one) => shown(one.force)).join(", ")} N.`
        : `Opening ${shown(opening)} mm, ${shown(value)} more than closed: the part can lie ${shown(gaps[0])} mm from all four pegs at once.`;
      return { words, numbers: { opening, gaps, pose: [pose.theta, pose.x, pose.y], forces: contacts.map((one) => one.force) } };
    },
  };
}

/** What the four pegs do to a turn about a point. */
function stopsOf(lesson, fixture, point) {
  const arms = armsAbout(lesson, fixture, point);
  const forces = fixture.pegs.map((peg) => peg[5]);
  return { arms, forces, moments: arms.map((arm, k) => arm * forces[k]) };
}

/** Numbers of pegs as words. */
function pegWords(numbers) {
  if (numbers.length < 2) return `peg ${numbers[0]}`;
  return `pegs ${numbers.slice(0, -1).join(", ")} and ${numbers.at(-1)}`;
}

/** Step 5: small turns about a centre that can be dragged. */
class ClosureStep {
  constructor() {
    this.section = document.getElementById("closure");
    this.stage = this.section.querySelector(".pictures");
    this.output = this.section.querySelector("output");
    this.table = this.section.querySelector("tbody");
    this.handle = this.section.querySelector("button.handle");
    this.handle.addEventListener("keydown", (event) => this.press(event));
    new ResizeObserver(() => this.lesson && this.draw()).observe(this.stage);
  }

  show(lesson) {
    this.lesson = lesson;
    this.fixture = lesson.fixtures[0];
    this.picture = new Picture("The part held by four pegs, their lines of push, and a centre to turn about", 0.95);
    this.polygon = new Picture("The four forces, each drawn from the end of the one before: they come back to the start", 0.8, 280);
    this.box = heldBox(lesson, this.fixture, 4 * lesson.toolkit.peg_radius);
    const [x0, y0, x1, y1] = this.box;
    this.point = [x0 + 0.62 * (x1 - x0), y0 + 0.4 * (y1 - y0)];
    this.stage.replaceChildren(this.picture.svg, this.polygon.svg);
    const { svg } = this.picture;
    let held = false;
    svg.onpointerdown = (event) => {
      if (event.button !== 0 || !event.target.closest(".grab")) return;
      held = true;
      svg.setPointerCapture(event.pointerId);
    };
    svg.onpointermove = (event) => held && this.move(this.picture.under(event));
    svg.onpointerup = svg.onpointercancel = () => { held = false; };
    this.draw();
  }

  press(event) {
    const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const way = ways[event.key];
    if (!way) return;
    event.preventDefault();
    const by = (this.box[2] - this.box[0]) / 50;
    this.move([this.point[0] + way[0] * by, this.point[1] + way[1] * by]);
  }

  move([x, y]) {
    const [x0, y0, x1, y1] = this.box;
    this.point = [Math.min(x1, Math.max(x0, x)), Math.min(y1, Math.max(y0, y))];
    this.draw();
  }

  draw() {
    const { lesson, fixture, picture, point } = this;
    const radius = lesson.toolkit.peg_radius;
    const { arms, forces, moments } = stopsOf(lesson, fixture, point);
    const contacts = contactsOf(lesson, fixture);
    const theta = fixture.pose[0];
    const side = (k) => (Math.abs(arms[k]) < 1e-6 ? "neither" : arms[k] > 0 ? "stops-left" : "stops-right");
    picture.fit(this.box);
    drawHeld(picture, lesson, fixture);
    const pushes = contacts.map(({ normal }) => turned(normal, theta).map((part) => -part));
    const lengths = arrowLengths(forces);
    contacts.forEach(({ peg }, k) => {
      const [ux, uy] = pushes[k];
      picture.line([peg[0] - 2000 * ux, peg[1] - 2000 * uy], [peg[0] + 2000 * ux, peg[1] + 2000 * uy], `action ${side(k)}`);
    });
    contacts.forEach(({ peg }, k) => {
      const [ux, uy] = pushes[k];
      picture.peg(peg, radius, k + 1, side(k));
      picture.arrow([peg[0] + radius * ux, peg[1] + radius * uy], [ux, uy], lengths[k], `push ${side(k)}`, "tail");
    });
    this.drawCentre(picture, point);
    this.drawPolygon(forces, pushes, side);
    const [left, right] = [1, -1].map((sign) => arms.flatMap((arm, k) => (sign * arm > 1e-6 ? [k + 1] : [])));
    const sum = moments.reduce((a, b) => a + b);
    const words = left.length && right.length
      ? `A turn to the left is stopped by ${pegWords(left)}, to the right by ${pegWords(right)}.`
      : "All four lines of push meet here: nothing stops the turn.";
    this.output.textContent = words;
    this.handle.setAttribute("aria-label", `Centre of turning, arrow keys move it. ${words}`);
    this.table.replaceChildren(...arms.map((arm, k) => pageNode("tr", { class: side(k) }, pageNode("th", { scope: "row" }, String(k + 1)),
      ...[forces[k], arm, moments[k]].map((value) => pageNode("td", {}, shown(value))),
      pageNode("td", {}, { "stops-left": "left", "stops-right": "right", neither: "neither" }[side(k)]))),
      pageNode("tr", { class: "sum" }, pageNode("th", { scope: "row", colspan: 3 }, "Sum"), pageNode("td", {}, shown(sum)), pageNode("td")));
    this.section.dataset.numbers = JSON.stringify({ point, arms, forces, moments, left, right });
  }

  drawCentre(picture, point) {
    const [cx, cy] = picture.at(point);
    picture.add(svgNode("path", { d: `M${cx - 13} ${cy + 5}A14 14 0 1 1 ${cx + 13} ${cy + 5}`, class: "turning" }));
    picture.dot(point, 5, "centre");
    picture.dot(point, 24, "grab reach");
  }

  /** Each force from the end of the one before, in the order of their directions: the loop is convex. */
  drawPolygon(forces, pushes, side) {
    const angle = (k) => Math.atan2(pushes[k][1], pushes[k][0]);
    const order = [0, 1, 2, 3].sort((one, other) => angle(one) - angle(other));
    const corners = [[0, 0]];
    order.forEach((k, i) => corners.push([0, 1].map((axis) => corners[i][axis] + forces[k] * pushes[k][axis])));
    const [x0, y0, x1, y1] = boxAround(corners);
    const more = 0.14 * Math.max(x1 - x0, y1 - y0) + 0.05;
    const { polygon } = this;
    polygon.fit([x0 - more, y0 - more, x1 + more, y1 + more]);
    polygon.words([x0 - more, y1 + more], "The forces, end to end", "tick", [0, 12]);
    order.forEach((k, i) => {
      polygon.arrow(corners[i + 1], pushes[k], forces[k] * polygon.scaleX, `push ${side(k)}`);
      const middle = [0, 1].map((axis) => (corners[i][axis] + corners[i + 1][axis]) / 2);
      polygon.words(middle, String(k + 1), "name middle", [11 * pushes[k][1], 4 + 11 * pushes[k][0]]);
    });
  }
}

/** Numbers of samples: powers of two, and what lies between. */
const SAMPLES = [4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 2048, 4096];

/** Step 6: what a plain program finds that tries some turns. @returns {StepParts} */
function everyOne(lesson) {
  const picture = new Picture("Each fixture at its turn, with the turns over which its pegs can touch; those found by sampling are filled", 0.85, 460);
  const fixtures = [...lesson.fixtures].sort((one, other) => one.pose[0] - other.pose[0]).slice(0, 60);
  const found = (index) => lesson.fixtures.filter((fixture) => isSampled(lesson, fixture, SAMPLES[index]));
  return {
    pictures: [picture],
    range: [0, SAMPLES.length - 1],
    by: 1,
    start: 5,
    settle: Math.round,
    drag: [(point) => (point[0] / 180) * (SAMPLES.length - 1)],
    draw(index) {
      const seen = new Set(found(index));
      picture.fit([0, -1, 180, fixtures.length], true);
      for (const x of ticks(0, 180, Math.max(3, Math.floor(picture.width / 90)))) picture.words([x, -1], `${x}°`, "tick middle", [0, 15]);
      picture.words([180, -1], "turn of the part", "tick end", [0, 29]);
      const count = SAMPLES[index];
      if (count <= 192) for (let k = 0; k < count; k += 1) {
        const x = FIRST_SAMPLE + (180 * k) / count;
        picture.line([x, -1], [x, fixtures.length], "sample");
      }
      fixtures.forEach((fixture, row) => {
        const [low, high] = commonRange(fixture).map((end) => Math.min(180, Math.max(0, end / DEGREE)));
        picture.line([low, row], [high, row], "reach-line");
        picture.dot([fixture.pose[0] / DEGREE, row], 4, seen.has(fixture) ? "found" : "lost");
      });
    },
    say(index) {
      const [count, all] = [found(index).length, lesson.fixtures.length];
      const words = `${SAMPLES[index]} turns tried: ${count} of ${all} fixtures found, ${all - count} lost. The list has all ${all}.`;
      return { words, numbers: { samples: SAMPLES[index], found: found(index).map((fixture) => fixture.rank) } };
    },
  };
}
