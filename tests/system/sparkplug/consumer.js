// node consumer.js decode: from each line "TOPIC RETAINED QOS HEX" a line of JSON.
// node consumer.js command NAME VALUE: a command with this metric, as bytes.
'use strict'
const readline = require('readline')
const { get } = require('sparkplug-payload')
const payloads = get('spBv1.0')

function plain(value) {
  if (value === undefined || value === null) return null
  return typeof value === 'object' && 'toNumber' in value ? value.toNumber() : value
}

function properties(of) {
  const found = {}
  for (const [key, property] of Object.entries(of ?? {})) found[key] = plain(property.value)
  return found
}

function decode(line) {
  const [topic, retained, qos, hex] = line.split(' ')
  const payload = payloads.decodePayload(Buffer.from(hex, 'hex'))
  return {
    topic,
    retained: retained === '1',
    qos: Number(qos),
    time: plain(payload.timestamp),
    seq: plain(payload.seq),
    metrics: (payload.metrics ?? []).map((metric) => ({
      name: metric.name ?? null,
      alias: plain(metric.alias),
      time: plain(metric.timestamp),
      type: metric.type,
      value: plain(metric.value),
      properties: properties(metric.properties)
    }))
  }
}

const [task, name, value] = process.argv.slice(2)
if (task === 'command') {
  process.stdout.write(payloads.encodePayload({
    timestamp: Date.now(),
    metrics: [{ name, type: 'Boolean', value: value === 'true' }]
  }))
} else {
  readline.createInterface({ input: process.stdin }).on('line', (line) => {
    console.log(JSON.stringify(decode(line)))
  })
}
