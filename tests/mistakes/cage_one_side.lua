local head = coif.head()
local cage = coif.cage {
  { at = { 0, 0, 0 } }, { at = { 9, 0, 0 } }, { at = { 0, 9, 0 } }, { at = { 0, 0, 9 }, to = { 0, 0, 12 } },
}
return coif.scene { head:deform { cage } }
