// decode: lines of `candump -L` in, a JSON object per message out, with the number of its last line.
// encode: a JSON object per message in, its lines out as a JSON list of texts.
const readline = require('readline')
const { FromPgn, pgnToCandump3 } = require('@canboat/canboatjs')

const parser = new FromPgn({ useCamel: true, returnNulls: true })
parser.on('error', (pgn, error) => {
  console.log(JSON.stringify({ error: error.message }))
})

let count = -1
const work = {
  decode: (line) => {
    count += 1
    const found = parser.parseString(line)
    if (found) console.log(JSON.stringify({ ...found, line: count }))
  },
  encode: (line) => console.log(JSON.stringify(pgnToCandump3(JSON.parse(line))))
}[process.argv[2]]

readline.createInterface({ input: process.stdin }).on('line', work)
