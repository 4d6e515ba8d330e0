// Sentences in, a line each; out, what Signal K makes of each: a JSON object of values by path.
const readline = require('readline')
const Parser = require('@signalk/nmea0183-signalk')

const parser = new Parser({ validateChecksum: true })
readline.createInterface({ input: process.stdin }).on('line', (line) => {
  let delta = null
  try {
    delta = parser.parse(line)
  } catch (error) {
    if (!error.message.includes('void')) throw error // it refuses some that say they are not valid
  }
  const values = delta ? delta.updates.flatMap((update) => update.values) : []
  console.log(JSON.stringify(Object.fromEntries(values.map((each) => [each.path, each.value]))))
})
