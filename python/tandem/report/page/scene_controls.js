// SPDX-License-Identifier: MIT
// Controls that rotate the scene and select frames: pointer, keys and buttons.
"use strict";

/** A sentence on the current frame. */
tandem.sceneWords = (data, frame) => {
  const time = data.times ? `, ${tandem.number(data.times[frame])} s` : "";
  const contacts = data.contacts ? `, ${tandem.number(data.contacts[frame].found)} ${data.contacts[frame].found === 1 ? "contact" : "contacts"}` : "";
  const surfaces = data.surfaces ? `, ${tandem.number(data.surfaces[frame].found)} ${data.surfaces[frame].found === 1 ? "polygon" : "polygons"}` : "";
  const bodies = data.bodies === data.of_bodies ? tandem.count(data.bodies, "body", "bodies") : `${data.bodies} of ${data.of_bodies} bodies`;
  return `Frame ${data.frames[frame]}${time}: ${bodies} of ${tandem.number(data.tetrahedra)} tetrahedra${contacts}${surfaces}.`;
};

/** The number of the frame that is shown first: that with the most contacts or polygons, or else the last. */
tandem.posterFrame = data => {
  const counted = data.contacts ?? data.surfaces;
  const found = counted?.map(frame => frame.found);
  return found ? found.indexOf(Math.max(...found)) : data.frames.length - 1;
};

tandem.view = data => {
  const {element} = tandem;
  const notes = data.notes.map(note => element("p", {class: "quiet"}, "Reduced: " + note + "."));
  const canvas = element("canvas", {id: "scene-canvas", tabindex: "0", role: "img", "aria-label": "The scene; arrows turn it, plus and minus zoom, " +
    "Page Up and Page Down go through frames"});
  const stage = element("div", {class: "stage"}, canvas);
  const words = element("p", {role: "status", "aria-live": "polite", id: "scene-words"}, tandem.sceneWords(data, tandem.posterFrame(data)));
  tandem.show("view", ...notes, stage, words, ...[tandem.depthLegend(data), tandem.pressureLegend(data)].filter(legend => legend));
  // The scene is made when it comes near the visible part of the page, so that a page with records loads faster.
  new IntersectionObserver((entries, observer) => {
    if (!entries.some(entry => entry.isIntersecting)) return;
    observer.disconnect();
    tandem.animate(data, stage, canvas, words);
  }, {rootMargin: "400px"}).observe(stage);
};

tandem.animate = (data, stage, canvas, words) => {
  const {element} = tandem;
  let view;
  try {
    view = new tandem.SceneView(data, canvas, stage.clientWidth / Math.max(stage.clientHeight, 1));
  } catch (error) {
    stage.replaceWith(element("p", {class: "bad"}, "This browser has no WebGL, which draws the scene: " + error.message));
    return;
  }
  const player = new tandem.Player(view, words);
  tandem.show("view", player.controls(), element("p", {class: "quiet"},
    "Drag, or use two fingers or arrows to turn; Ctrl and the wheel, + or - to zoom; Page Up and Page Down for frames; space to play."));
  tandem.keepScrolling(stage);
  player.listen(canvas);
  view.colour("body");
  new ResizeObserver(() => view.resize(stage.clientWidth, stage.clientHeight)).observe(stage);
  tandem.darkness.addEventListener("change", () => view.draw());
  tandem.sceneView = view;
};

/** Leaves the wheel, and one finger, to the page, which they scroll. The listeners come before those of the library's controls. */
tandem.keepScrolling = stage => {
  const leave = isForPage => event => { if (isForPage(event)) event.stopPropagation(); };
  stage.addEventListener("wheel", leave(event => !event.ctrlKey), {capture: true, passive: true});
  for (const name of ["touchstart", "touchmove"]) stage.addEventListener(name, leave(event => event.touches.length < 2), {capture: true, passive: true});
};

tandem.Player = class {
  constructor(view, words) {
    Object.assign(this, {view, words, timer: null});
    this.orbit = new THREE.OrbitControls(view.camera, view.renderer.domElement);
    this.orbit.target.copy(view.centre);
    this.orbit.enableKeys = false;
    this.orbit.touches.TWO = THREE.TOUCH.DOLLY_ROTATE;  // one finger scrolls
    this.orbit.update();
    this.orbit.addEventListener("change", () => view.draw());
  }

  controls() {
    const {element} = tandem;
    const last = this.view.data.frames.length - 1;
    const button = (text, label, action) => element("button", {type: "button", "aria-label": label, title: label, onclick: action}, text);
    this.slider = element("input", {type: "range", id: "frame-slider", min: 0, max: last, value: this.view.frame, oninput: () => this.go(+this.slider.value)});
    this.playButton = button("Play", "Play or pause", () => this.play());
    const colours = tandem.choice("colour", [["body", "bodies apart"], ["chunk", "chunks of 32 tetrahedra apart"], ["none", "none"]]
      .map(([value, text]) => ({value, text})), value => this.view.colour(value));
    const frames = last > 0 ? [element("label", {class: "wide"}, "frame", this.slider), button("◀", "Frame before", () => this.step(-1)), this.playButton,
      button("▶", "Next frame", () => this.step(1))] : [];
    const {contacts, surfaces} = this.view.data;
    const parts = [contacts && this.partButton("Contacts", shown => { this.view.contacts.visible = shown; }),
      surfaces && this.partButton("Surfaces", shown => this.view.showSurfaces(shown))].filter(button => button);
    return element("div", {class: "controls", role: "group", "aria-label": "The scene"}, ...frames,
      button("←", "Turn left", () => this.turn(-1, 0)), button("→", "Turn right", () => this.turn(1, 0)), button("↑", "Turn up", () => this.turn(0, 1)),
      button("↓", "Turn down", () => this.turn(0, -1)), button("+", "Nearer", () => this.zoom(0.85)), button("−", "Farther", () => this.zoom(1 / 0.85)), colours, ...parts);
  }

  /** A button that shows and hides what lies over or in the bodies. */
  partButton(name, show) {
    const made = tandem.element("button", {type: "button", "aria-pressed": "true", onclick: () => {
      const shown = made.getAttribute("aria-pressed") !== "true";
      made.setAttribute("aria-pressed", String(shown));
      show(shown);
      this.view.draw();
    }}, name);
    return made;
  }

  listen(canvas) {
    const keys = {ArrowLeft: () => this.turn(-1, 0), ArrowRight: () => this.turn(1, 0), ArrowUp: () => this.turn(0, 1), ArrowDown: () => this.turn(0, -1),
      "+": () => this.zoom(0.85), "=": () => this.zoom(0.85), "-": () => this.zoom(1 / 0.85), PageUp: () => this.step(-1), PageDown: () => this.step(1), " ": () => this.play()};
    canvas.addEventListener("keydown", event => {
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
    });
  }

  /** Rotates the camera around its target by 15 degrees. */
  turn(right, up) {
    const from = this.view.camera.position.clone().sub(this.orbit.target);
    const top = new THREE.Vector3(0, 1, 0);
    from.applyAxisAngle(top, right * Math.PI / 12);
    const side = new THREE.Vector3().crossVectors(top, from).normalize();
    const tilted = from.clone().applyAxisAngle(side, -up * Math.PI / 12);
    if (Math.abs(tilted.angleTo(top) - Math.PI / 2) < Math.PI / 2 - 0.05) from.copy(tilted);
    this.view.camera.position.copy(this.orbit.target).add(from);
    this.orbit.update();
    this.view.draw();
  }

  zoom(factor) {
    const {camera} = this.view;
    camera.position.sub(this.orbit.target).multiplyScalar(factor).add(this.orbit.target);
    this.orbit.update();
    this.view.draw();
  }

  go(frame) {
    this.view.show(frame);
    this.slider.value = frame;
    this.slider.setAttribute("aria-valuetext", "frame " + this.view.data.frames[frame]);
    this.words.textContent = tandem.sceneWords(this.view.data, frame);
  }

  /** Goes forward or back by frames, from the last to the first. */
  step(by) {
    const count = this.view.data.frames.length;
    this.go((this.view.frame + by + count) % count);
  }

  play() {
    if (this.view.data.frames.length < 2) return;
    if (this.timer) clearInterval(this.timer);
    this.timer = this.timer ? null : setInterval(() => this.step(1), 60);
    this.playButton.textContent = this.timer ? "Pause" : "Play";
    this.words.setAttribute("aria-live", this.timer ? "off" : "polite");
  }
};
