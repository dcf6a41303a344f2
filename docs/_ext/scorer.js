// Order of search results: pages that explain come before lists of functions, and those before pages of single scenes.
// Search adds up scores of about 5 (word in the text) to 15 (word in the title) for each word.
var Scorer = {
  objNameMatch: 6,
  objPartialMatch: 2,
  objPrio: { 0: 5, 1: 2, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 1,
  weights: [
    [/^reference\/scene/, 12],
    [/^(scenes|help|start)\//, 10],
    [/^reference\//, 6],
    [/^(tutorials|plugins)\//, 5],
    [/^theory\//, 3],
    [/^measured\//, -2],
    [/^api\/generated\//, -8],
    [/^gallery\//, -4],
    [/^about\/changelog/, -10],
  ],
  score([docname, title, anchor, description, score]) {
    const hit = Scorer.weights.find(([pattern]) => pattern.test(docname));
    return score + (hit ? hit[1] : 0);
  },
};
