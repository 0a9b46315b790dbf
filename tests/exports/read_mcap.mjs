// Reads an MCAP file with the format's own library and prints what it found as JSON:
// node read_mcap.mjs NODE_MODULES FILE
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(process.argv[2] + "/");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const bytes = new Uint8Array(readFileSync(process.argv[3]));

// Record by record, with every checksum that is there.
const stream = new McapStreamReader({ validateCrcs: true });
stream.append(bytes);
let streamed = 0;
for (let record; (record = stream.nextRecord()); ) if (record.type === "Message") ++streamed;

// By the index, as a viewer does.
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.slice(Number(offset), Number(offset + length)),
  },
});
const topics = {};
let last = 0n, sorted = true;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  sorted &&= message.logTime >= last;
  last = message.logTime;
  const value = JSON.parse(new TextDecoder().decode(message.data));
  const properties = JSON.parse(new TextDecoder().decode(schema.data)).properties;
  const unknown = Object.keys(value).filter((key) => !(key in properties));
  const topic = (topics[channel.topic] ??= {
    schema: schema.name, encoding: schema.encoding, messages: 0, unknown: [], first: value,
    firstTime: String(message.logTime),
  });
  topic.messages += 1;
  topic.unknown.push(...unknown);
}
console.log(JSON.stringify({
  streamed, topics, sorted, complete: stream.done(),
  statistics: Number(reader.statistics.messageCount), chunks: reader.chunkIndexes.length,
}));
