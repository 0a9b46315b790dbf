// Writes the bags of ROS 2 beside this file: npm's @mcap/core makes the containers and Foxglove's
// packages the messages. In a folder of its own: npm install @mcap/core @foxglove/rosmsg
// @foxglove/rosmsg2-serialization @foxglove/rosmsg-msgs-common lz4js @foxglove/wasm-zstd
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(process.cwd() + "/");
const { McapWriter } = require("@mcap/core");
const { MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { ros2humble } = require("@foxglove/rosmsg-msgs-common");
const { parse } = require("@foxglove/rosmsg");
const lz4 = require("lz4js");
const zstd = require("@foxglove/wasm-zstd");

const here = new URL(".", import.meta.url).pathname;
const START_NS = 1700000000123456789n, STEP_NS = 20000000n, COUNT = 40;

// The type's definition with those of its parts, as a recorder stores it.
function definitionsOf(type) {
  const definitions = [], texts = [], seen = new Set();
  const add = (name) => {
    if (seen.has(name)) return;
    seen.add(name);
    const definition = ros2humble[name];
    definitions.push({ ...definition, name });
    texts.push((texts.length ? "=".repeat(80) + `\nMSG: ${name}\n` : "") +
      definition.definitions.filter((d) => !d.isConstant)
        .map((d) => `${d.type}${d.isArray ? `[${d.arrayLength ?? ""}]` : ""} ${d.name}`).join("\n"));
    for (const part of definition.definitions) if (part.isComplex) add(part.type);
  };
  add(type);
  return { definitions, text: texts.join("\n") };
}

function pose(k, offset) {
  return {
    place: { x: 0.1 + 0.01 * Math.sin(0.3 * k) + offset, y: (-0.02 * k) / COUNT, z: 0.05 * Math.cos(0.2 * k) },
    turn: { x: 0, y: 0, z: Math.sin(0.01 * k), w: Math.cos(0.01 * k) },
  };
}
const poseStamped = ({ place, turn }) => ({ pose: { position: place, orientation: turn } });

function* messages() {
  for (let k = 0; k < COUNT; ++k) {
    const stamp = START_NS + BigInt(k) * STEP_NS;
    for (const [arm, offset] of [["PSM1", 0], ["PSM2", 0.5]]) {
      yield [`/${arm}/measured_cp`, "geometry_msgs/PoseStamped", `${arm}_base`, stamp, poseStamped(pose(k, offset))];
    }
    yield ["/PSM1/setpoint_cp", "geometry_msgs/PoseStamped", "", stamp, poseStamped(pose(k + 1, 0))];
    const { place, turn } = pose(k, -0.2);
    yield ["/aurora/tool", "geometry_msgs/TransformStamped", "aurora", stamp + 7000000n,
      { child_frame_id: "tool", transform: { translation: place, rotation: turn } }];
    yield ["/ft_sensor/wrench", "geometry_msgs/WrenchStamped", "", stamp,
      { wrench: { force: { x: 0.1 * k, y: -0.2, z: 0.3 * Math.sin(k) }, torque: { x: 9, y: 9, z: 9 } } }];
    yield ["/PSM1/measured_js", "sensor_msgs/JointState", "", stamp,
      { name: ["yaw", "pitch", "insertion"], position: [0.01 * k, -0.02 * k, 0.1 + 0.001 * k],
        velocity: [], effort: [0.5, 0.25 * k, 1] }];
    if (k % 10 !== 0) continue;
    const data = new Uint8Array(144);
    for (let i = 0; i < 144; ++i) {
      data[i] = (3 * Math.floor((i % 24) / 3) + 5 * Math.floor(i / 24) + 7 * (i % 3) + k) % 256;
    }
    yield ["/endoscope/left/image_raw", "sensor_msgs/Image", "", stamp,
      { height: 6, width: 8, encoding: "rgb8", is_bigendian: 0, step: 24, data }];
    yield ["/endoscope/right/image_raw/compressed", "sensor_msgs/CompressedImage", "", stamp,
      { format: "png", data: readFileSync(here + "grey.png") }];
    for (const [side, distortion_model, d] of [["left", "plumb_bob", [0.1, -0.2, 0.001, 0.002, 0]],
      ["right", "equidistant", [0.1, 0.2, 0.3, 0.4]]]) {
      yield [`/endoscope/${side}/camera_info`, "sensor_msgs/CameraInfo", "", stamp,
        { height: 6, width: 8, distortion_model, d, k: [7, 0, 3.5, 0, 7.5, 2.5, 0, 0, 1],
          r: [1, 0, 0, 0, 1, 0, 0, 0, 1], p: [7, 0, 3.5, 0, 0, 7.5, 2.5, 0, 0, 0, 1, 0],
          binning_x: 0, binning_y: 0,
          roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false } }];
    }
  }
}

async function write(file, compressChunk) {
  const parts = [];
  let size = 0n;
  const writable = {
    position: () => size,
    write: async (bytes) => { parts.push(Buffer.from(bytes)); size += BigInt(bytes.byteLength); },
  };
  const writer = new McapWriter({ writable, compressChunk, chunkSize: 8192 });
  await writer.start({ profile: "ros2", library: "" });
  const schemas = new Map(), channels = new Map();
  let sequence = 0;
  for (const [topic, type, frame, stamp, content] of messages()) {
    if (!schemas.has(type)) {
      const { definitions, text } = definitionsOf(type);
      const id = await writer.registerSchema({
        name: type.replace("/", "/msg/"), encoding: "ros2msg", data: new TextEncoder().encode(text) });
      schemas.set(type, { id, encoder: new MessageWriter(definitions) });
    }
    const schema = schemas.get(type);
    if (!channels.has(topic)) {
      channels.set(topic, await writer.registerChannel({
        schemaId: schema.id, topic, messageEncoding: "cdr", metadata: new Map() }));
    }
    const header = { frame_id: frame,
      stamp: { sec: Number(stamp / 1000000000n), nanosec: Number(stamp % 1000000000n) } };
    await writer.addMessage({ channelId: channels.get(topic), sequence: sequence++,
      logTime: stamp + 1500000n, publishTime: stamp,
      data: schema.encoder.writeMessage({ header, ...content }) });
  }
  await writer.end();
  writeFileSync(here + file, Buffer.concat(parts));
}

await zstd.isLoaded;
await write("ros2_lz4.mcap", (bytes) => ({ compression: "lz4", compressedData: lz4.compress(bytes) }));
await write("ros2_zstd.mcap", (bytes) => ({ compression: "zstd", compressedData: zstd.compress(bytes) }));
await write("ros2_plain.mcap");
