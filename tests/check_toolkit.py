#!/usr/bin/env python3
"""Check a result of another toolkit (translating-clamp, opening-vise, edge) against the rules that the manual gives.

usage: check_toolkit.py RESULT.json [--truth TRUTH.json]

Every fixture is checked by itself (holes, contact, penetration, clearances, closure, clamping, forces, plate or jaws), then
duplicates are looked for, and with --truth the whole set is compared with a complete one. Fixtures within 1e-6 of a rule's
edge are 'marginal': they may be in the result or not. With "clamps": 2 either side may list all pairs or the best of each seat. Uses none of the project's code; needs numpy. Exit 0 when all holds.
"""
import argparse, json, sys
from math import atan, atan2, cos, degrees, hypot, pi, radians, sin, sqrt
import numpy as np

TOL, EDGE, TAU = 1e-6, 1e-6, 2*pi
DIRS = {'-x': (-1., 0.), '+x': (1., 0.), '-y': (0., -1.), '+y': (0., 1.)}

# ---- geometry of the part -------------------------------------------------------------------------------------------
def segments(loops):
    out = []
    for loop in loops:
        n = len(loop); L = []
        for k in range(n):
            (x0, y0, b), (x1, y1, _) = loop[k], loop[(k+1) % n]
            if abs(b) < 1e-12: L.append(('line', np.array([x0, y0]), np.array([x1, y1])))
            else:
                th = 4*atan(b); ch = hypot(x1-x0, y1-y0); r = ch/(2*sin(abs(th)/2)); d = r*cos(th/2)*(1 if b > 0 else -1)
                c = np.array([(x0+x1)/2-(y1-y0)/ch*d, (y0+y1)/2+(x1-x0)/ch*d])
                L.append(('arc', c, r, atan2(y0-c[1], x0-c[0]), th))
        out.append(L)
    return out

def nearest(p, s):
    """(distance, outward normal with material on the left, distance of the foot from the segment's nearer end)"""
    if s[0] == 'line':
        a, b = s[1], s[2]; L = np.hypot(*(b-a)); t = (b-a)/L; u = (p-a) @ t; uc = min(max(u, 0), L)
        return np.hypot(*(p-a-uc*t)), np.array([t[1], -t[0]]), min(u, L-u)
    _, c, r, a0, th = s; v = p-c; sg = 1 if th > 0 else -1; ang = ((atan2(v[1], v[0])-a0)*sg) % TAU; sw = abs(th)
    n = sg*v/max(np.hypot(*v), 1e-300)
    if ang <= sw: return abs(np.hypot(*v)-r), n, r*min(ang, sw-ang)
    e = [c+r*np.array([cos(a0), sin(a0)]), c+r*np.array([cos(a0+th), sin(a0+th)])]
    return min(np.hypot(*(p-q)) for q in e), n, -r*min(ang-sw, TAU-ang)

def inside(p, segs):
    w = 0.0
    for s in segs:
        k = 1 if s[0] == 'line' else 48
        pts = [s[1], s[2]] if s[0] == 'line' else [s[1]+s[2]*np.array([cos(s[3]+s[4]*i/k), sin(s[3]+s[4]*i/k)]) for i in range(k+1)]
        for a, b in zip(pts, pts[1:]):
            a = a-p; b = b-p; w += atan2(a[0]*b[1]-a[1]*b[0], a @ b)
    return abs(w) > pi

def faces(by_loop):
    """segment -> face: the smallest index among the neighbours that continue the same line or circle"""
    rep, base = {}, 0
    for L in by_loop:
        n = len(L)
        def same(i, j):
            f, g = L[i], L[j]
            if f[0] != g[0]: return False
            if f[0] == 'line':
                t = (f[2]-f[1])/np.hypot(*(f[2]-f[1])); u = (g[2]-g[1])/np.hypot(*(g[2]-g[1])); d = g[1]-f[1]
                return np.abs(t-u).sum() < 1e-9 and abs(d[0]*t[1]-d[1]*t[0]) < 1e-7
            return np.hypot(*(f[1]-g[1])) < 1e-7 and abs(f[2]-g[2]) < 1e-7 and f[4]*g[4] > 0
        start = next((k for k in range(n) if not same(k-1, k)), None)
        if start is None: rep.update({base+k: base for k in range(n)})
        else:
            cur = []
            for k in list(range(start, n))+list(range(start)):
                cur = cur+[k] if cur and same(cur[-1], k) else [k]
                for m in cur: rep[base+m] = base+min(cur)
        base += n
    return rep

class Part:
    def __init__(self, loops):
        by = segments(loops); self.segs = [s for L in by for s in L]; self.rep = faces(by); self.runs = {}
        for k, v in self.rep.items(): self.runs.setdefault(v, []).append(k)
        P = np.array([q for s in self.segs for q in ([s[1], s[2]] if s[0] == 'line' else [s[1]+s[2]*np.array([cos(s[3]+s[4]*i/60), sin(s[3]+s[4]*i/60)]) for i in range(61)])])
        self.c = (P.min(0)+P.max(0))/2; self.L = max(np.hypot(*(P-p).T).max() for p in P)/2
    def dist(self, q): return min(nearest(q, s)[0] for s in self.segs)
    def touch(self, q, seg, rho, name):
        """(faults, marginal, outward normal) of a disc of radius rho at q said to touch the face of seg"""
        run = self.runs[self.rep[seg]]; d, n, end = min((nearest(q, self.segs[k]) for k in run), key=lambda z: z[0]); bad = []; marg = False
        if abs(d-rho) > TOL: bad.append(f'{name} is {d-rho:+.2e} from segment {seg}')
        if len(run) == 1:
            if end < -TOL: bad.append(f'{name} is past the end of its segment')
            marg = end < EDGE
        for k, s in enumerate(self.segs):
            if k in run: continue
            dk, _, ek = nearest(q, s)
            if dk < rho-TOL: bad.append(f'{name} enters the workpiece by {rho-dk:.2e}'); break
            marg |= dk < rho+EDGE and ek > 1e-3      # touches a second face well inside it: a corner of the locus
        if inside(q, self.segs): bad.append(f'{name} lies in the workpiece')
        return bad, marg, n

def null_vector(W):
    W = np.array(W); lam = np.array([(-1)**i*np.linalg.det(np.delete(W, i, 0)) for i in range(4)])
    return None if abs(lam.sum()) < 1e-13 else lam/lam.sum()

def path_gap(part, a, b):
    """distance of the straight piece ab from the part's boundary, segment by segment in closed form"""
    L = np.hypot(*(b-a)); t = (b-a)/max(L, 1e-300); at = lambda u: a+min(max(u, 0), L)*t
    off = lambda q: np.hypot(*(q-at((q-a) @ t))); best = np.inf
    for s in part.segs:
        best = min(best, nearest(a, s)[0], nearest(b, s)[0])
        if s[0] == 'line':
            p, q = s[1], s[2]; best = min(best, off(p), off(q)); c = t[0]*(q-p)[1]-t[1]*(q-p)[0]
            if abs(c) > 1e-12:
                u = ((p-a)[0]*(q-p)[1]-(p-a)[1]*(q-p)[0])/c; v = ((p-a)[0]*t[1]-(p-a)[1]*t[0])/c
                if 0 <= u <= L and 0 <= v <= 1: return 0.
        else:
            _, c, r, a0, th = s; k = (c-a) @ t; h = np.hypot(*(c-a-k*t)); at_k = [k] if h >= r else [k-sqrt(r*r-h*h), k+sqrt(r*r-h*h)]
            best = min([best]+[off(c+r*np.array([cos(z), sin(z)])) for z in (a0, a0+th)]+[nearest(a+u*t, s)[0] for u in at_k if 0 <= u <= L])
    return best

def capsule(part, a, b, r):
    """does a disc of radius r moved from a to b stay out of the part? True, False or None (within the edge); starts 1e-3 from a."""
    L = np.hypot(*(b-a))
    if L == 0: return True
    g = path_gap(part, a+(b-a)*min(1e-3/L, 1), b)-r; return False if g < -EDGE else None if g < EDGE else True

# ---- one fixture ------------------------------------------------------------------------------------------------------
def frame(f):
    th = radians(f['pose']['theta_deg']); return np.array([[cos(th), -sin(th)], [sin(th), cos(th)]]), np.array([f['pose']['x'], f['pose']['y']])

def forces(f, items, lam, unit, bad):
    for it, l in zip(items, lam):
        if 'force' in it and abs(it['force']-l/unit) > 1e-6*max(1, abs(l/unit)): bad.append(f'force {it["force"]} should be {l/unit:.9f}')

def holes(V, f, pegs, bad, y0=0.0):
    """locators stand in the holes they name; all named holes, rows and columns lie on the plate"""
    lx, ly = V['pitch']; cols, rows = [], []
    for i, p in enumerate(pegs):
        if abs(p['x']-p['column']*lx) > TOL or abs(p['y']-y0-p['row']*ly) > TOL: bad.append(f'locator {i} is not in its hole')
        cols.append(p['column']); rows.append(p['row'])
    if len(set(zip(cols, rows))) < len(pegs): bad.append('two locators in one hole')
    c = f['pegs'][-1]; d = f['direction']
    if d[1] == 'x':
        rows.append(c['row'])
        if abs(c['y']-y0-c['row']*ly) > TOL: bad.append('the clamp is off its row')
    else:
        cols.append(c['column'])
        if abs(c['x']-c['column']*lx) > TOL: bad.append('the clamp is off its column')
    if V.get('travel') is not None:
        if not c.get('hole'): bad.append('no hole for the clamp')
        else: cols.append(c['hole'][0]); rows.append(c['hole'][1])
    if min(cols) < 0 or min(rows) < 0: bad.append('negative row or column')
    if V.get('columns') and max(cols) >= V['columns']: bad.append('column outside the plate')
    if V.get('rows') and max(rows) >= V['rows']: bad.append('row outside the plate')

def clamp_body(V, f, part, R, t, bad, y0=0.0):
    """tip and locators apart; with travel: the hole, its distance, and the way from hole to tip"""
    lx, ly = V['pitch']; rho, rc = V['peg_radius'], V.get('clamp_radius', V['peg_radius']); c = f['pegs'][-1]; dv = np.array(DIRS[f['direction']]); tip = np.array([c['x'], c['y']]); marg = False; end = tip
    if V.get('travel') is not None and c.get('hole'):
        end = np.array([c['hole'][0]*lx, y0+c['hole'][1]*ly]); w = (tip-end) @ dv; t0, t1 = V['travel']
        if abs((tip-end)[0]*dv[1]-(tip-end)[1]*dv[0]) > TOL: bad.append("the clamp's hole is off its line")
        if not t0-TOL <= w <= t1+TOL: bad.append(f'the clamp travels {w:.6f}')
        marg |= min(abs(w-t0), abs(w-t1)) < EDGE
        ok = capsule(part, R.T @ (tip-t), R.T @ (end-t), rc); marg |= ok is None
        if ok is False: bad.append('the clamp enters the workpiece between its hole and its tip')
    for i, p in enumerate(f['pegs'][:-1]):
        v = np.array([p['x'], p['y']])-tip; L2 = (end-tip) @ (end-tip); k = min(max(v @ (end-tip)/L2, 0), 1) if L2 > 0 else 0.; g = np.hypot(*(v-k*(end-tip)))-rho-rc
        if g < -TOL: bad.append(f'the clamp meets locator {i}')
        marg |= abs(g) < EDGE
    return marg

def check_clamp(f, V, part):
    R, t = frame(f); bad, marg = [], False; W = []
    if f['direction'] not in V['directions']: bad.append('this clamp direction was not asked for')
    if [p['role'] for p in f['pegs']] != ['locator']*3+['clamp']: return ['three locators, then the clamp'], False
    holes(V, f, f['pegs'][:3], bad)
    for i, p in enumerate(f['pegs']):
        q = R.T @ (np.array([p['x'], p['y']])-t); r = V['peg_radius'] if i < 3 else V.get('clamp_radius', V['peg_radius'])
        b, m, n = part.touch(q, p['segment'], r, f'peg {i}'); bad += b; marg |= m; W.append([*n, ((q-part.c)[0]*n[1]-(q-part.c)[1]*n[0])/part.L])
    marg |= clamp_body(V, f, part, R, t, bad)
    lam = null_vector(W)
    if lam is None: return bad+['no force closure'], marg
    if lam.min() < -EDGE: bad.append(f'no force closure ({lam.min():.2e})')
    push = -(R @ np.array(W[3][:2])) @ np.array(DIRS[f['direction']])*lam[3]
    if push < -EDGE: bad.append(f'the clamp pulls ({push:.2e})')
    if push > EDGE: forces(f, f['pegs'], lam, push, bad)
    return bad, marg or lam.min() < EDGE or push < EDGE

def check_vise(f, V, part):
    lx, ly = V['pitch']; rho = V['peg_radius']; R, t = frame(f); bad, marg = [], False; P = f['pegs']; pos = np.array([[p['x'], p['y']] for p in P])
    left = [i for i in range(len(P)) if P[i]['jaw'] == 'left']; right = [i for i in range(len(P)) if P[i]['jaw'] == 'right']
    if (len(left), len(right)) != {'I': (2, 2), 'II': (3, 1)}.get(f['type']): return ['wrong pegs per jaw'], False
    for side in (left, right):
        d = (pos[side]-pos[side[0]])/[lx, ly]
        if np.abs(d-d.round()).max() > TOL: bad.append('off the lattice')
        if np.ptp(d[:, 0].round()) > V['columns']-1: bad.append('too many columns')
        if len({tuple(x) for x in d.round()}) < len(side): bad.append('two pegs in one hole')
        for k in ('column', 'row'):
            c = np.array([P[i][k] for i in side]); j = 0 if k == 'column' else 1
            if np.abs((c-c[0])-d[:, j].round()).max() > 0: bad.append(f'{k} numbers disagree with the coordinates')
        if any(not 0 <= P[i]['column'] < V['columns'] for i in side): bad.append('column outside the jaw')
    dy = (pos[right[0], 1]-pos[left[0], 1]-V.get('row_offset', 0.0))/ly
    if abs(dy-round(dy)) > TOL: bad.append('rows of the jaws disagree')
    if V.get('rows') and any(not 0 <= p['row'] < V['rows'] for p in P): bad.append('row outside the jaw')
    opening = pos[right, 0].min()-pos[left, 0].max()
    if opening < V['min_gap']-TOL: bad.append('jaws too close')
    marg |= opening < V['min_gap']+EDGE
    sep = (pos[right[0], 0]-P[right[0]]['column']*lx)-(pos[left[0], 0]+(V['columns']-1-P[left[0]]['column'])*lx)
    if abs(sep-f['jaw_separation']) > TOL: bad.append('jaw_separation disagrees with the coordinates')
    if V.get('max_opening') and sep > V['max_opening']+TOL: bad.append('opens too far')
    W, fx = [], []
    for i, p in enumerate(P):
        q = R.T @ (pos[i]-t); b, m, n = part.touch(q, p['segment'], rho, f'peg {i}'); bad += b; marg |= m
        W.append([*n, ((q-part.c)[0]*n[1]-(q-part.c)[1]*n[0])/part.L]); fx.append(-(R @ n)[0])
    lam = null_vector(W)
    if lam is None: return bad+['no force closure'], marg
    if lam.min() < -EDGE: bad.append(f'no force closure ({lam.min():.2e})')
    clamp = sum(lam[i]*fx[i] for i in left)*(-1 if V['kind'] == 'opening-vise' else 1)
    if clamp < -EDGE: bad.append(f'{"opening" if V["kind"] == "opening-vise" else "closing"} the vise does not clamp ({clamp:.2e})')
    if clamp > EDGE: forces(f, P, lam, clamp, bad)
    return bad, marg or lam.min() < EDGE or clamp < EDGE

def against_wall(f, V, part, R, t, bad, pegs):
    """wrenches of the wall's two ends and of the pegs; the part flush, nothing in the wall. (wrenches, marginal)"""
    low = []                                                             # lowest points of every segment, in the plate's frame
    for s in part.segs:
        if s[0] == 'line': low += [R @ s[1]+t, R @ s[2]+t]
        else:
            low += [R @ (s[1]+s[2]*np.array([cos(a), sin(a)]))+t for a in (s[3], s[3]+s[4])]; a = atan2(*(R.T @ np.array([0, -1.]))[::-1])
            if ((a-s[3])*(1 if s[4] > 0 else -1)) % TAU <= abs(s[4]): low.append(R @ (s[1]+s[2]*np.array([cos(a), sin(a)]))+t)
    low = np.array(low); on = low[np.abs(low[:, 1]) < TOL]
    if low[:, 1].min() < -TOL: bad.append('the part enters the wall')
    a, b = np.array(f['wall']['from']), np.array(f['wall']['to'])
    if len(on) < 2 or np.ptp(on[:, 0]) < TOL: bad.append('the part does not lie flush against the wall')
    elif abs(on[:, 0].min()-a[0]) > 1e-5 or abs(on[:, 0].max()-b[0]) > 1e-5 or abs(a[1])+abs(b[1]) > TOL: bad.append('from and to are not the ends of the contact')
    W, marg = [], False
    for p in (a, b): q = R.T @ (p-t); n = R.T @ np.array([0, -1.]); W.append([*n, ((q-part.c)[0]*n[1]-(q-part.c)[1]*n[0])/part.L])
    for i, p in enumerate(pegs):
        r = V['peg_radius'] if i == 0 else V.get('clamp_radius', V['peg_radius']); q = R.T @ (np.array([p['x'], p['y']])-t)
        bb, m, n = part.touch(q, p['segment'], r, f'peg {i}'); bad += bb; marg |= m; W.append([*n, ((q-part.c)[0]*n[1]-(q-part.c)[1]*n[0])/part.L])
        if p['y'] < r-TOL: bad.append(f'peg {i} enters the wall')
        marg |= p['y'] < r+EDGE
    return W, marg

def check_edge(f, V, part):
    R, t = frame(f); bad, marg = [], False; y0 = V['wall_offset']
    if f['direction'] not in V['directions']: bad.append('this clamp direction was not asked for')
    if [p['role'] for p in f['pegs']] != ['locator', 'clamp']: return ['one locator, then the clamp'], False
    holes(V, f, f['pegs'][:1], bad, y0)
    W, m = against_wall(f, V, part, R, t, bad, f['pegs']); marg |= m
    marg |= clamp_body(V, f, part, R, t, bad, y0)
    lam = null_vector(W)
    if lam is None: return bad+['no force closure'], marg
    if lam.min() < -EDGE: bad.append(f'no force closure ({lam.min():.2e})')
    push = -(R @ np.array(W[3][:2])) @ np.array(DIRS[f['direction']])*lam[3]
    if push < -EDGE: bad.append(f'the clamp pulls ({push:.2e})')
    if push > EDGE: forces(f, f['pegs'], lam[2:], push, bad)
    return bad, marg or lam.min() < EDGE or push < EDGE

# ---- two clamps -------------------------------------------------------------------------------------------------------
def margin5(W):
    """largest min over null vectors >= 0 with sum 1 of five wrenches of rank 3 (a max of the least of five straight lines); -1: none"""
    N = np.linalg.svd(np.array(W).T)[2][3:].T; s = N.sum(0)          # null vectors N @ z
    if np.hypot(*s) < 1e-12: return -1.
    z0 = s/(s @ s); z1 = np.array([-s[1], s[0]])/np.hypot(*s); a, b = N @ z0, N @ z1; best = -1.
    for i in range(5):
        for j in range(i):
            if abs(b[i]-b[j]) > 1e-14: best = max(best, (a+b*(a[j]-a[i])/(b[i]-b[j])).min())
    return best if best > 0 else max(best, a.min())

def interval(b1, b2):
    """open interval of f2/f1 in which b1 f1 + b2 f2 > 0"""
    b1, b2 = (np.where(np.abs(b) < 1e-9, 0, b) for b in (b1, b2))
    return max([0.]+[-x/y for x, y in zip(b1, b2) if y > 0]), min([np.inf]+[-x/y for x, y in zip(b1, b2) if y < 0])

def two_clamps(f, V, part, R, t, W, stops, bad, y0=0.0):
    """W: the wrenches of what sets the pose; stops: its locators. Returns marginal."""
    C = f['pegs'][len(stops):]; marg = False; dirs = [c['direction'] for c in C]; turned = sorted({'-': '+', '+': '-'}[d[0]]+d[1] for d in dirs)
    ask = [sorted(p) for p in V['directions']]
    if sorted(dirs) not in ask and not (V['kind'] == 'translating-clamp' and turned in ask): bad.append('this pair of directions was not asked for')
    if f['directions'] != dirs: bad.append('directions disagree with the clamps')
    if dirs != sorted(dirs, key=list(DIRS).index): bad.append('the clamps are not in order')
    rc = V.get('clamp_radius', V['peg_radius']); ends = []; push = []
    for k, c in enumerate(C):
        g = dict(direction=c['direction'], pegs=stops+[c]); holes(V, g, stops, bad, y0); marg |= clamp_body(V, g, part, R, t, bad, y0)
        tip = np.array([c['x'], c['y']]); q = R.T @ (tip-t); b, m, n = part.touch(q, c['segment'], rc, f'clamp {k}'); bad += b; marg |= m
        W.append([*n, ((q-part.c)[0]*n[1]-(q-part.c)[1]*n[0])/part.L]); push.append(-(R @ n) @ np.array(DIRS[c['direction']]))
        if push[k] < -EDGE: bad.append(f'clamp {k} pulls'); marg |= True
        marg |= push[k] < EDGE
        h = c.get('hole'); e = np.array([h[0]*V['pitch'][0], y0+h[1]*V['pitch'][1]]) if V.get('travel') is not None and h else tip; ends.append((np.minimum(tip, e), np.maximum(tip, e)))
    gap = np.hypot(*np.maximum(0, np.maximum(ends[0][0]-ends[1][1], ends[1][0]-ends[0][1])))-2*rc
    if gap < -TOL: bad.append('the clamps meet')
    marg |= abs(gap) < EDGE
    A = np.array(W[:3]).T; det = abs(np.linalg.det(A))
    if det < 5e-7: return bad.append('the locators do not fix the pose') or True
    marg |= det < 1e-5; a = [-np.linalg.solve(A, np.array(w)) for w in W[3:]]
    for k in (0, 1):
        z = a[k].min()/(1+np.abs(a[k]).sum()); marg |= 1e-9 < abs(z) < EDGE
        if z > EDGE: bad.append(f'clamp {k} holds the part alone')
    m = margin5(W)
    if m < -EDGE or m <= 0: bad.append(f'no force closure ({m:.2e})')
    marg |= m < EDGE
    if min(push) > EDGE:
        B = np.array([a[0]/push[0], a[1]/push[1]]); lo, hi = interval(*B); got = f.get('ratio')
        if got is not None:
            for u, v in zip(got, (lo, hi)):
                u = 1e9 if u is None else u; v = min(v, 1e9)
                if abs(u-v) > 1e-6*max(1, v) and min(u, v) < 1e6: bad.append(f'ratio {got} should be {[lo, hi]}')
        rows = f['wall']['forces'] if 'wall' in f else []; rows = rows+[p['force'] for p in f['pegs'] if 'force' in p]
        want = [B[:, i] for i in range(3)]+[np.array([1/push[0], 0]), np.array([0, 1/push[1]])]
        if len(rows) == 5 and any(np.abs(np.array(u)-v).max() > 1e-6*max(1, np.abs(v).max()) for u, v in zip(rows, want)): bad.append('forces disagree')
        q = f.get('quality', {}).get('closure_margin')
        if q is not None and abs(q-m) > 1e-6: bad.append(f'closure margin {q} should be {m:.9f}')
    f['_score'] = (degrees(atan(hi)-atan(lo)), m) if min(push) > EDGE else (0., m); q = f.get('quality', {}).get('clamp_freedom')
    if q is not None and abs(q-f['_score'][0]) > 1e-4: bad.append(f'clamp freedom {q} should be {f["_score"][0]:.6f}')
    return marg

def check_clamp2(f, V, part):
    if [p['role'] for p in f['pegs']] != ['locator']*3+['clamp']*2: return ['three locators, then two clamps'], False
    R, t = frame(f); bad, marg, W = [], False, []
    for i, p in enumerate(f['pegs'][:3]):
        q = R.T @ (np.array([p['x'], p['y']])-t); b, m, n = part.touch(q, p['segment'], V['peg_radius'], f'peg {i}'); bad += b; marg |= m
        W.append([*n, ((q-part.c)[0]*n[1]-(q-part.c)[1]*n[0])/part.L])
    return bad, two_clamps(f, V, part, R, t, W, f['pegs'][:3], bad) or marg

def check_edge2(f, V, part):
    if [p['role'] for p in f['pegs']] != ['locator']+['clamp']*2: return ['one locator, then two clamps'], False
    R, t = frame(f); bad = []; W, marg = against_wall(f, V, part, R, t, bad, f['pegs'])
    return bad, two_clamps(f, V, part, R, t, W[:3], f['pegs'][:1], bad, V['wall_offset']) or marg

# ---- identity -----------------------------------------------------------------------------------------------------------
def identity(f, V, rep, seat=False):
    """(key, orientation, place on the part of the pegs' middle): equal for two descriptions of one fixture"""
    lx, ly = V['pitch']; th = radians(f['theta_deg'] if 'theta_deg' in f else f['pose']['theta_deg']); P = f['pegs']
    xy = np.array([[p['x'], p['y']] for p in P]); face = [rep[p['segment']] for p in P]; best = None
    R = np.array([[cos(th), -sin(th)], [sin(th), cos(th)]])
    if V.get('clamps') == 2:
        k0 = 3 if V['kind'] == 'translating-clamp' else 1; dirs = [p['direction'] for p in P[k0:]]; y0 = V.get('wall_offset', 0.); best = None; turns = []
        for sg in ((1, -1) if k0 == 3 else (1,)):
            dd = [d if sg == 1 else {'-': '+', '+': '-'}[d[0]]+d[1] for d in dirs]
            for o in range(k0):
                base = [xy[o, 0], xy[o, 1] if k0 == 3 else y0]; g = lambda i, k: round(sg*(xy[i, k]-base[k])/(lx, ly)[k])
                c = (tuple(sorted(dd)), tuple(sorted((face[i], g(i, 0), g(i, 1)) for i in range(k0))), () if seat else tuple(sorted((dd[n], face[k0+n], g(k0+n, 1 if dd[n][1] == 'x' else 0)) for n in (0, 1))))
                if best is None or c < best: best, turns = c, [sg]
                elif c == best and sg not in turns: turns.append(sg)
        mid = R.T @ (xy[:k0].mean(0)-np.array([f['pose']['x'], f['pose']['y']])) if 'x' in f.get('pose', {}) else None
        return best, tuple(th+(0 if sg == 1 else pi) for sg in turns), mid
    if V['kind'] == 'translating-clamp':
        d = f['direction']; sg = 1 if d[0] == '-' else -1; k = 1 if d[1] == 'x' else 0; turn = sg
        for o in range(3):
            c = (d[1], tuple(sorted((face[i], round(sg*(xy[i, 0]-xy[o, 0])/lx), round(sg*(xy[i, 1]-xy[o, 1])/ly)) for i in range(3))), face[3], round(sg*(xy[3, k]-xy[o, k])/(lx, ly)[k]))
            best = c if best is None or c < best else best
    elif V['kind'] == 'edge':
        d = f['direction']; turn = 1; y0 = V['wall_offset']
        best = (d, face[0], round((xy[0, 1]-y0)/ly), face[1], round((xy[1, 1]-y0)/ly) if d[1] == 'x' else round((xy[1, 0]-xy[0, 0])/lx))
    else:
        for sg in (1, -1):
            L = [i for i in range(4) if (P[i]['jaw'] == 'right') == (sg == -1)]; Q = [i for i in range(4) if i not in L]
            if len(L) < len(Q): continue
            for o in L:
                for q in Q:
                    c = (len(L), tuple(sorted((face[i], round(sg*(xy[i, 0]-xy[o, 0])/lx), round(sg*(xy[i, 1]-xy[o, 1])/ly)) for i in L)),
                         tuple(sorted((face[i], round(sg*(xy[i, 0]-xy[q, 0])/lx), round(sg*(xy[i, 1]-xy[o, 1])/ly)) for i in Q)))
                    if best is None or c < best: best, turn = c, sg
    n = {'translating-clamp': 3, 'edge': 1}.get(V['kind'], 4)
    mid = R.T @ (xy[:n].mean(0)-np.array([f['pose']['x'], f['pose']['y']])) if 'x' in f.get('pose', {}) else None
    return best, th+(0 if turn == 1 else pi), mid

def show(f): return json.dumps({k: v for k, v in f.items() if k[0] != "_"})

def same(a, b):
    if not isinstance(a[1], tuple): turn = abs((a[1]-b[1]+pi) % TAU-pi) < 1e-5
    else: turn = any(abs((u-v+pi) % TAU-pi) < 1e-5 for u in a[1] for v in b[1])
    return turn and (a[2] is None or b[2] is None or np.hypot(*(a[2]-b[2])) < 1e-4)

def by_seat(F, V, rep):
    """fixtures with two clamps -> [(identity of the seat with its pair of directions, [fixtures])]"""
    groups = {}
    for f in F:
        k = identity(f, V, rep, True); L = groups.setdefault(k[0], [])
        for h, g in L:
            if same(h, k): g.append(f); break
        else: L.append((k, [f]))
    return [g for L in groups.values() for g in L]

def score(f):
    """how good a pair is: (clamp freedom in degrees, closure margin)"""
    q = f.get('_score') or (f['quality']['clamp_freedom'], f['quality']['closure_margin']); return tuple(q)
def less(a, b): return a[0] < b[0]-1e-4 or (a[0] < b[0]+1e-4 and a[1] < b[1]-EDGE)
def best_pair(F):
    top = max(score(f)[0] for f in F); return max((f for f in F if score(f)[0] > top-1e-4), key=lambda f: round(score(f)[1], 9))

def seat_report(D, T, V, part):
    """two listings of which at least one gives the best of each seat: (missing, extra, wrong) seats"""
    def table(E, tv, checked):
        out = []
        for k, g in by_seat(E['fixtures'], tv, part.rep):
            mar = lambda f: f.get('_marginal', f.get('marginal', False))
            if E.get('listing', 'all') == 'all':
                ok = [f for f in g if not mar(f)]; n = len(g); nm = n-len(ok); sure = score(best_pair(ok)) if ok else (0., 0.); top = score(best_pair(g))
            else: f = g[0]; n = f['pairs']; nm = f.get('pairs_marginal', 0); top = tuple(f.get('best_any', score(f))); sure = (0., 0.) if mar(f) else score(f)
            out.append((k, n-nm, n, sure, top, g[0]))
        return out
    A = table(D, V, True); B = {}; missing, extra, wrong, hit = [], [], [], set()
    for n, a in enumerate(A): B.setdefault(a[0][0], []).append((n, a))
    for k, n0, n1, sure, top, f in table(T, T['toolkit'], False):
        m = [(n, a) for n, a in B.get(k[0], []) if same(a[0], k)]; hit.update(n for n, _ in m)
        if not m:
            if n0: missing.append(f)
            continue
        _, (_, c0, c1, s2, t2, g) = m[0]
        if c1 < n0 or c0 > n1 or less(t2, sure) or less(top, s2): wrong.append((g, n0, n1, sure, top, c0, c1, s2, t2))
    extra = [a[5] for n, a in enumerate(A) if n not in hit and a[1]]
    return missing, extra, wrong, len(T['fixtures'])

def main():
    ap = argparse.ArgumentParser(); ap.add_argument('result'); ap.add_argument('--truth'); a = ap.parse_args()
    D = json.load(open(a.result)); V = D['toolkit']; part = Part(D['workpiece']['loops']); faults = 0; got = {}; marg = {}
    two = V.get('clamps') == 2; best = two and D.get('listing') == 'best'
    check = {'translating-clamp': check_clamp2 if two else check_clamp, 'edge': check_edge2 if two else check_edge}.get(V['kind'], check_vise); F = D['fixtures']+D.get('twins', [])
    for n, f in enumerate(F):
        bad, m = check(f, V, part); marg[n] = f['_marginal'] = m
        if bad:
            faults += 1
            if faults <= 10: print(f'fixture {n}: '+'; '.join(bad))
        k = identity(f, V, part.rep, best)
        if any(same(k, h) for h, _ in got.get(k[0], [])) and not m: print(f'fixture {n}: listed twice'); faults += 1
        got.setdefault(k[0], []).append((k, n))
    if two and not best and 'pairs' in D and D['pairs'] != len(F): print(f'pairs says {D["pairs"]}'); faults += 1
    if best and ('pairs' in D and D['pairs'] != sum(f['pairs'] for f in F)): print('pairs is not the sum over the seats'); faults += 1
    for T in {f['type'] for f in F} | set(D['counts']):
        n = sum(f['type'] == T for f in D['fixtures'])
        if D['counts'].get(T, 0) != n: print(f'counts say {D["counts"].get(T)} of type {T}, listed {n}'); faults += 1
    line = f'{len(F)} fixtures, {faults} faulty'
    if a.truth:
        T = json.load(open(a.truth))
        for k, v in T['toolkit'].items():
            if (sorted(map(sorted, V.get(k) or [])) != sorted(map(sorted, v)) if k == 'directions' else V.get(k) != v): print(f'toolkit.{k} is {V.get(k)}, the truth has {v}'); faults += 1
        if two and (best or T.get('listing') == 'best'):
            missing, extra, wrong, n = seat_report(D, T, V, part)
            for w in wrong[:5]: print('seat with other pairs (pairs, margins wanted; got):', w[1:], show(w[0]))
            for f in missing[:5]: print('missing', show(f))
            for f in extra[:5]: print('extra', show(f))
            print(line+f'; truth {n} seats: {len(missing)} missing, {len(extra)} extra, {len(wrong)} with other pairs'); sys.exit(1 if faults or missing or extra or wrong else 0)
        hit = set(); missing = []
        for f in T['fixtures']:
            k = identity(f, T['toolkit'], part.rep); m = [n for h, n in got.get(k[0], []) if same(h, k)]; hit.update(m)
            if not m and not f['marginal']: missing.append(f)
        extra = [n for n in range(len(F)) if n not in hit and not marg[n]]
        for f in missing[:5]: print('missing', show(f))
        for n in extra[:5]: print('extra', show(F[n]))
        line += f'; truth {len(T["fixtures"])} ({T["marginal"]} marginal): {len(missing)} missing, {len(extra)} extra'
        faults += len(missing)+len(extra)
    print(line); sys.exit(1 if faults else 0)

if __name__ == '__main__': main()
