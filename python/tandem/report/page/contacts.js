// SPDX-License-Identifier: MIT
// Contacts of a scene: spikes along the normals, coloured by depth, and the legend of these colours.
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

/** The length of a spike in a picture of bodies of this radius: less where there are many, which would hide each other. */
tandem.spikeLength = (radius, count) => radius * Math.min(0.06, Math.max(0.02, 0.8 / Math.sqrt(count)));

/** Two directions across a normal, of the same length: [x, y, z, x, y, z]. */
tandem.across = ([x, y, z], length) => {
  const least = [x, y, z].map(Math.abs).indexOf(Math.min(...[x, y, z].map(Math.abs)));
  const normal = new THREE.Vector3(x, y, z);
  const first = new THREE.Vector3().setComponent(least, 1).cross(normal).setLength(length);
  return [first.toArray(), first.cross(normal).setLength(length).toArray()].flat();
};

/** Draws the contacts of a frame over the bodies: a pyramid from each point along its normal, in units of the scene, so that it grows with the picture. */
tandem.Contacts = class {
  constructor(data, scene) {
    this.data = data;
    // All are drawn, the deepest last: depths are the message, and the bodies would hide most of them.
    const look = new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors, side: THREE.DoubleSide, depthTest: false});
    this.object = new THREE.Mesh(new THREE.BufferGeometry(), look);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    scene.add(this.object);
  }

  set visible(visible) {
    this.object.visible = visible;
  }

  /** `radius`: that of the bodies in view. */
  show(frame, radius) {
    const contacts = this.data.contacts[frame];
    const points = tandem.points(contacts);
    const normals = new Int8Array(tandem.bytes(contacts.normals).buffer);
    const depths = tandem.depthsOf(this.data, frame);
    const length = tandem.spikeLength(radius || 1, depths.length);
    const order = [...depths.keys()].sort((a, b) => depths[a] % tandem.noDepth - depths[b] % tandem.noDepth);
    const positions = [], colours = [];
    for (const i of order) {
      const normal = [0, 1, 2].map(axis => normals[3 * i + axis] / 127);
      const sides = tandem.across(normal, 0.2 * length);
      const corner = (side, sign) => [0, 1, 2].map(axis => points[3 * i + axis] + sign * sides[3 * side + axis]);
      const base = [corner(0, 1), corner(1, 1), corner(0, -1), corner(1, -1)];
      const tip = [0, 1, 2].map(axis => points[3 * i + axis] + length * normal[axis]);
      base.forEach((from, j) => positions.push(...from, ...base[(j + 1) % 4], ...tip));
      const colour = tandem.depthColour(this.data, depths[i]).toArray();
      for (let corner = 0; corner < 12; ++corner) colours.push(...colour);
    }
    const set = (name, values) => this.object.geometry.setAttribute(name, new THREE.BufferAttribute(Float32Array.from(values), 3));
    set("position", positions);
    set("color", colours);
  }
};
