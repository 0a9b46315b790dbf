// Writes a bag of ROS 2 from JSON on standard input: write_mcap.mjs FILE.
import { readFileSync, writeFileSync } from "node:fs";
import { McapWriter } from "@mcap/core";

const { schemas, messages } = JSON.parse(readFileSync(0));
const parts = [];
let size = 0n;
const writable = {
  position: () => size,
  write: async (bytes) => { parts.push(Buffer.from(bytes)); size += BigInt(bytes.byteLength); },
};
const writer = new McapWriter({ writable });
await writer.start({ profile: "ros2", library: "" });
const schemaIds = {}, channels = {};
let sequence = 0;
for (const { topic, type, t_ns, data } of messages) {
  schemaIds[type] ??= await writer.registerSchema(
    { name: type, encoding: "ros2msg", data: new TextEncoder().encode(schemas[type]) });
  channels[topic] ??= await writer.registerChannel(
    { schemaId: schemaIds[type], topic, messageEncoding: "cdr", metadata: new Map() });
  await writer.addMessage({ channelId: channels[topic], sequence: sequence++,
    logTime: BigInt(t_ns), publishTime: BigInt(t_ns), data: Buffer.from(data, "hex") });
}
await writer.end();
writeFileSync(process.argv[2], Buffer.concat(parts));
