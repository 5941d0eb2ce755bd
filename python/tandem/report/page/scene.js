// SPDX-License-Identifier: MIT
// The three-dimensional view of a scene. Rigid bodies with one mesh are instances of it; deformable bodies have their own vertices.
"use strict";

tandem.bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
tandem.shorts = text => new Uint16Array(tandem.bytes(text).buffer);

/** Points from 16-bit coordinates within their box. */
tandem.points = ({lower, size, points}) => Float32Array.from(tandem.shorts(points), (value, i) => lower[i % 3] + size[i % 3] * value / 65535);

tandem.bodyColours = [0xd55e00, 0x0072b2, 0x009e73, 0xe6c229, 0xcc79a7, 0x56b4e9, 0xe69f00, 0x7b5ea7];
tandem.fixedColour = 0x8a8f98;

tandem.maxFittedPoints = 100000;
tandem.sphereOf = points => new THREE.Box3().setFromPoints(points).getBoundingSphere(new THREE.Sphere());
tandem.cornersOf = ({min, max}) => Array.from({length: 8}, (_, i) => new THREE.Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z));
tandem.verticesOf = ({attributes: {position}}) => Array.from({length: position.count}, (_, i) => new THREE.Vector3().fromArray(position.array, 3 * i));

/** Draws frames of a scene. tandem.Player has the controls. */
tandem.SceneView = class {
  /** `aspect`: width of the canvas over its height. */
  constructor(data, canvas, aspect) {
    Object.assign(this, {data, colouring: "body"});
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, aspect, 0.01, 1000);
    this.light = new THREE.DirectionalLight(0xffffff, 0.75);
    this.camera.add(this.light);
    this.light.position.set(0.5, 1, 1);
    this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 0.45));
    this.bodyMeshes = new Uint32Array(tandem.bytes(data.body_meshes).buffer);
    this.kinds = tandem.bytes(data.body_kinds);
    this.makeBodies();
    this.contacts = data.contacts ? new tandem.Contacts(data, this.scene) : null;
    if (data.surfaces) this.surfaces = new tandem.Surfaces(data, this.scene);
    this.showSurfaces(Boolean(data.surfaces));
    this.show(tandem.posterFrame(data));
    this.lookAtAll();
  }

  /** A geometry whose triangles share no vertices, so that each has its own normal and colour. */
  geometry(mesh, points) {
    const corners = mesh.wide ? new Uint32Array(tandem.bytes(mesh.triangles).buffer) : tandem.shorts(mesh.triangles);
    const positions = new Float32Array(corners.length * 3);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(corners.length * 3), 3));
    Object.assign(geometry.userData ??= {}, {corners, chunks: tandem.bytes(mesh.chunks)});
    this.setPositions(geometry, points);
    return geometry;
  }

  setPositions(geometry, points) {
    const {corners} = geometry.userData;
    const positions = geometry.attributes.position;
    corners.forEach((corner, i) => {
      for (let axis = 0; axis < 3; ++axis) positions.array[3 * i + axis] = points[3 * corner + axis];
    });
    positions.needsUpdate = true;
    geometry.computeVertexNormals();
    geometry.computeBoundingBox();
    geometry.computeBoundingSphere();
  }

  /** Makes one object of all rigid bodies with one mesh and colour, because instances have no colours in this version of the library. */
  makeBodies() {
    this.objects = [];
    this.deformable = [];
    const groups = new Map();
    const count = tandem.bodyColours.length;
    for (let body = 0; body < this.data.bodies; ++body) {
      if (this.kinds[body] & 2) {
        this.deformable.push(this.add(this.bodyMeshes[body], [body], body % count));
        continue;
      }
      const tint = this.kinds[body] & 1 ? count : body % count;
      const key = this.bodyMeshes[body] * (count + 1) + tint;
      if (!groups.has(key)) groups.set(key, {mesh: this.bodyMeshes[body], bodies: [], tint});
      groups.get(key).bodies.push(body);
    }
    this.geometries = new Map();
    this.rigid = [...groups.values()].map(({mesh, bodies, tint}) => this.add(mesh, bodies, tint));
  }

  /** A geometry that shares the buffers of a mesh. Objects must not share the geometry itself, which the library would treat as one set of instances. */
  sharing(mesh) {
    if (!this.geometries.has(mesh)) this.geometries.set(mesh, this.geometry(this.data.meshes[mesh], tandem.points(this.data.meshes[mesh])));
    const known = this.geometries.get(mesh);
    const geometry = new THREE.BufferGeometry();
    for (const name of ["position", "normal", "color"]) geometry.setAttribute(name, known.attributes[name]);
    Object.assign(geometry, {userData: known.userData, boundingBox: known.boundingBox, boundingSphere: known.boundingSphere});
    return geometry;
  }

  add(mesh, bodies, tint) {
    const rigid = !(this.kinds[bodies[0]] & 2);
    const own = this.data.meshes[mesh];
    const geometry = rigid ? this.sharing(mesh) : this.geometry(own, tandem.points(own));
    const material = new THREE.MeshLambertMaterial({side: THREE.DoubleSide});
    const object = rigid ? new THREE.InstancedMesh(geometry, material, bodies.length) : new THREE.Mesh(geometry, material);
    object.frustumCulled = false;
    Object.assign(object.userData, {bodies, colour: tint < tandem.bodyColours.length ? tandem.bodyColours[tint] : tandem.fixedColour});
    this.objects.push(object);
    this.scene.add(object);
    return object;
  }

  colour(by) {
    this.colouring = by;
    const chunk = new THREE.Color();
    for (const {geometry} of this.objects) {
      const colours = geometry.attributes.color;
      for (let i = 0; i < colours.count; ++i) {
        const number = geometry.userData.chunks[Math.floor(i / 3)];
        chunk.setHSL((number * 0.381966) % 1, 0.65, 0.45 + 0.2 * (number % 2));
        chunk.toArray(colours.array, 3 * i);
      }
      colours.needsUpdate = true;
    }
    for (const object of this.objects) {
      const chunks = by === "chunk";
      object.material.vertexColors = chunks ? THREE.VertexColors : THREE.NoColors;
      object.material.color.set(chunks ? 0xffffff : by === "body" ? object.userData.colour : 0xb8bec6);
      object.material.needsUpdate = true;
    }
    this.draw();
  }

  show(frame) {
    this.frame = frame;
    const poses = tandem.shorts(this.data.poses[frame]);
    const {lower, size} = this.data;
    const position = new THREE.Vector3(), rotation = new THREE.Quaternion(), scale = new THREE.Vector3(1, 1, 1), matrix = new THREE.Matrix4();
    for (const object of this.rigid) {
      object.userData.bodies.forEach((body, i) => {
        const at = 7 * body;
        position.set(...[0, 1, 2].map(axis => lower[axis] + size[axis] * poses[at + axis] / 65535));
        rotation.set(...[3, 4, 5, 6].map(part => (poses[at + part] - 32768) / 32767)).normalize();
        object.setMatrixAt(i, matrix.compose(position, rotation, scale));
      });
      object.instanceMatrix.needsUpdate = true;
    }
    this.deformable.forEach((object, i) => this.setPositions(object.geometry, tandem.points(this.data.deformed[frame][i])));
    this.contacts?.show(frame, this.radius);
    this.surfaces?.show(frame);
    this.draw();
  }

  /** Shows the contact surfaces inside translucent bodies, or bodies alone. */
  showSurfaces(shown) {
    if (this.surfaces) this.surfaces.visible = shown;
    for (const {material} of this.objects) Object.assign(material, {transparent: shown, opacity: shown ? tandem.translucent : 1, depthWrite: !shown});
  }

  /** Sets the camera so that all bodies that are not fixed fill the view, or all bodies if all are fixed. */
  lookAtAll() {
    let points = this.pointsOf(body => !(this.kinds[body] & 1));
    if (!points.length) points = this.pointsOf(() => true);
    const sphere = tandem.sphereOf(points);
    this.radius = sphere.radius || 1;
    const all = tandem.sphereOf(this.pointsOf(() => true)).radius || 1;
    this.camera.up.set(0, 1, 0);  // opposite to gravity
    this.camera.near = this.radius / 200;
    this.camera.far = this.radius * 20 + all * 10;
    this.fill(points, sphere.center, new THREE.Vector3(0.6, 0.55, 1).normalize());
    this.contacts?.show(this.frame, this.radius);
  }

  /** Moves the camera, which looks against the direction `back`, so that the points just fit the view. A point at (x, y, z) in the camera's axes
   * around `centre` is in view if |x - shift| <= tangent * (distance - z), and for y alike: two bounds for each of two unknowns. */
  fill(points, centre, back) {
    const right = new THREE.Vector3().crossVectors(this.camera.up, back).normalize();
    const up = new THREE.Vector3().crossVectors(back, right);
    const tangent = Math.tan(this.camera.fov * Math.PI / 360);
    const corners = points.map(point => point.clone().sub(centre));
    const fit = (axis, slope) => {
      const most = sign => corners.reduce((found, corner) => Math.max(found, sign * corner.dot(axis) + slope * corner.dot(back)), -Infinity);
      const [over, under] = [most(1), most(-1)];
      return {distance: (over + under) / (2 * slope), shift: (over - under) / 2};
    };
    const across = fit(right, tangent * this.camera.aspect);
    const upward = fit(up, tangent);
    this.centre = centre.clone().addScaledVector(right, across.shift).addScaledVector(up, upward.shift);
    this.camera.position.copy(this.centre).addScaledVector(back, 1.04 * Math.max(across.distance, upward.distance, this.radius / 100));
    this.camera.lookAt(this.centre);
    this.camera.updateProjectionMatrix();
  }

  /** Points that enclose each body that is included: its vertices, or the corners of its box in a scene with many. */
  pointsOf(isIncluded) {
    const points = [], matrix = new THREE.Matrix4();
    const all = this.objects.reduce((sum, object) => sum + object.userData.bodies.length * object.geometry.attributes.position.count, 0);
    const enclosing = geometry => all > tandem.maxFittedPoints ? tandem.cornersOf(geometry.boundingBox) : tandem.verticesOf(geometry);
    for (const object of this.rigid) {
      const own = enclosing(object.geometry);
      object.userData.bodies.forEach((body, i) => {
        if (!isIncluded(body)) return;
        matrix.fromArray(object.instanceMatrix.array, 16 * i);
        for (const point of own) points.push(point.clone().applyMatrix4(matrix));
      });
    }
    for (const object of this.deformable) if (isIncluded(object.userData.bodies[0])) for (const point of enclosing(object.geometry)) points.push(point);
    return points;
  }

  resize(width, height) {
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(height, 1);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    this.renderer.setClearColor(new THREE.Color(tandem.darkness.matches ? 0x14181d : 0xf3f5f7));
    this.renderer.render(this.scene, this.camera);
  }
};
