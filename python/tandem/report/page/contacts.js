// SPDX-License-Identifier: MIT
// Contacts of a scene: points and normals, coloured by depth, and the legend of these colours.
"use strict";

tandem.plainContact = 0xff2d95;
tandem.noDepth = 65535;

/** The colour of a depth from 0 to 65534, or of a contact without depth. */
tandem.depthColour = (data, depth) => depth === tandem.noDepth ? new THREE.Color(tandem.plainContact)
  : tandem.scaleColour(data, depth / (tandem.noDepth - 1));

/** Depths of the contacts of a frame, from 0 to 65534; none have depths if none penetrates. */
tandem.depthsOf = (data, frame) => data.deepest > 0 ? tandem.shorts(data.contacts[frame].depths)
  : new Uint16Array(tandem.bytes(data.contacts[frame].normals).length / 3).fill(tandem.noDepth);

/** The scale of depths with its ends and its middle, in the scene's unit; nothing if no contact penetrates. */
tandem.depthLegend = data => {
  if (!data.contacts || !(data.deepest > 0)) return null;
  const plain = data.contacts.some((_, frame) => tandem.depthsOf(data, frame).includes(tandem.noDepth));
  return tandem.scaleLegend(data, "depth-legend", "depth of contacts", part => `${tandem.number(part * data.deepest)} ${data.units}`,
    plain ? "pink: a contact without depth" : null);
};

/** Draws the contacts of a frame over the bodies. */
tandem.Contacts = class {
  constructor(data, scene) {
    this.data = data;
    const look = {vertexColors: THREE.VertexColors, depthTest: false};
    this.points = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({size: 4, sizeAttenuation: false, ...look}));
    this.normals = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial(look));
    for (const object of [this.points, this.normals]) {
      object.frustumCulled = false;
      object.renderOrder = 1;
      scene.add(object);
    }
  }

  set visible(visible) {
    this.points.visible = this.normals.visible = visible;
  }

  /** `radius`: that of the bodies in view, for the length of normals. */
  show(frame, radius) {
    const contacts = this.data.contacts[frame];
    const points = tandem.points(contacts);
    const normals = new Int8Array(tandem.bytes(contacts.normals).buffer);
    const depths = tandem.depthsOf(this.data, frame);
    const length = (radius || 1) * 0.03;
    const lines = new Float32Array(points.length * 2);
    const colours = new Float32Array(points.length);
    for (let i = 0; i < points.length; i += 3) {
      tandem.depthColour(this.data, depths[i / 3]).toArray(colours, i);
      for (let axis = 0; axis < 3; ++axis) {
        lines[2 * i + axis] = points[i + axis];
        lines[2 * i + 3 + axis] = points[i + axis] + length * normals[i + axis] / 127;
      }
    }
    const lineColours = Float32Array.from(lines, (_, i) => colours[3 * Math.floor(i / 6) + i % 3]);
    const set = ({geometry}, name, values) => geometry.setAttribute(name, new THREE.BufferAttribute(values, 3));
    set(this.points, "position", points);
    set(this.points, "color", colours);
    set(this.normals, "position", lines);
    set(this.normals, "color", lineColours);
  }
};
