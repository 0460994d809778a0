#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""SciPy baseline: rho(B_eps), B_eps = X^-1 Y_eps, for a triangular lattice of N disks in n_sd vertical strips.
usage: spectral_scipy.py N nsd [neps=20] [tol=1e-8] [max seconds] [method: arpack|arpack60|dense] [v(erbose)]
 arpack: eigsh k=1 default ncv=20, maxiter 500 restarts, matrix-free;  arpack60: same with ncv=60
 dense : form the dense interface matrix strip by strip (multi-RHS sparse solves on the strip's own interface
         columns), then scipy.linalg.eigvalsh of the largest eigenvalue only
What a competent user writes: assemble H_E (2 nb_E x nc_E), M_E (masses split by multiplicity), A_E (signed
boolean, interface velocities V_E1 - V_E2 = 0, chain of multiplicity-1 gluings per shared disk), W_E = H^T M^-1 H,
one sparse LU (splu) of W_E + eps I per eps and per strip, and ARPACK (eigsh) on the symmetrised operator
 L^-1 Y L^-T with X = L L^T (X diagonal for multiplicity-2 disks), matrix-free.
Prints a CSV line per eps and the total.
"""
import sys, time, numpy as np, scipy.sparse as sp, scipy.sparse.linalg as sla
N=int(sys.argv[1]); nsd=int(sys.argv[2]); neps=int(sys.argv[3]) if len(sys.argv)>3 else 20
tol=float(sys.argv[4]) if len(sys.argv)>4 else 1e-8
maxsec=float(sys.argv[5]) if len(sys.argv)>5 else 1e9
meth=sys.argv[6] if len(sys.argv)>6 else 'arpack'; quiet=len(sys.argv)<=7
import scipy.linalg as dla
T=time.perf_counter; t0=T()
# --- lattice (width:height about 2:1), unit diameter, unit masses
ncol=max(2,int(round(np.sqrt(2*N*np.sqrt(3)/2)))); nrow=-(-N//ncol)
k=np.arange(N); row=k//ncol; col=k%ncol; x=col+0.5*(row%2); y=row*np.sqrt(3)/2
tree=__import__('scipy.spatial',fromlist=['cKDTree']).cKDTree(np.c_[x,y]); P=tree.query_pairs(1.0+1e-6,output_type='ndarray')
i,j=P[:,0],P[:,1]; d=np.c_[x[j]-x[i],y[j]-y[i]]; n=d/np.linalg.norm(d,axis=1)[:,None]; nc=len(i)
mid=0.5*(x[i]+x[j]); xmin,xmax=x.min(),x.max(); sd=np.minimum(((mid-xmin)/(xmax-xmin+1e-9)*nsd).astype(int),nsd-1)
# --- multiplicity of each disk
inc=sp.csr_matrix((np.ones(2*nc),(np.r_[i,j],np.r_[sd,sd])),shape=(N,nsd)); inc.data[:]=1; inc.sum_duplicates(); inc.data[:]=1
mult=np.asarray(inc.sum(1)).ravel(); 
# --- gluing rows: for a shared disk in strips e1<e2<..: V_e1 - V_e2 = 0, V_e2 - V_e3 = 0 ...
inc=inc.tocsr(); inc.sort_indices(); shared=np.nonzero(mult>1)[0]
g=0; gl=[[] for _ in range(nsd)]
for b in shared:
    es=inc.indices[inc.indptr[b]:inc.indptr[b+1]]
    for a in range(len(es)-1): gl[es[a]].append((g,b,1.)); gl[es[a+1]].append((g,b,-1.)); g+=1
ng=2*g
loc=np.full(N,-1); S=[]
X=sp.csr_matrix((ng,ng))
for e in range(nsd):
    c=np.nonzero(sd==e)[0]; bodies=np.unique(np.r_[i[c],j[c]]); loc[bodies]=np.arange(len(bodies)); nb=len(bodies); m=1.0/mult[bodies]
    li,lj=loc[i[c]],loc[j[c]]; q=np.arange(len(c))
    H=sp.csr_matrix((np.r_[-n[c,0],-n[c,1],n[c,0],n[c,1]],(np.r_[2*li,2*li+1,2*lj,2*lj+1],np.r_[q,q,q,q])),shape=(2*nb,len(c)))
    Minv=sp.diags(np.repeat(1/m,2))
    G=gl[e]; rr=np.array([t[0] for t in G],int); bb=loc[np.array([t[1] for t in G],int)] if G else np.zeros(0,int); ss=np.array([t[2] for t in G])
    A=sp.csr_matrix((np.r_[ss,ss],(np.r_[2*rr,2*rr+1],np.r_[2*bb,2*bb+1])),shape=(ng,2*nb))
    W=(H.T@Minv@H).tocsc(); AhT=(H.T@Minv@A.T).tocsr(); X=X+A@Minv@A.T
    S.append((W,AhT,AhT.T.tocsr(),sp.identity(len(c),format='csc')))
offd=abs(X-sp.diags(X.diagonal())).max() if ng else 0
# symmetrise: X = L L^T ; X is diagonal when all shared disks have multiplicity 2
if offd<1e-14:
    s=1/np.sqrt(X.diagonal()); Lsolve=lambda v:s*v; LTsolve=Lsolve; xd='diagonal'
else:
    lux=sla.splu(X.tocsc(),permc_spec='NATURAL',diag_pivot_thresh=0,options=dict(SymmetricMode=True)); dd=np.sqrt(lux.U.diagonal()); xd='non-diagonal'
    Lf=(lux.L@sp.diags(dd)).tocsr(); LTf=Lf.T.tocsr()
    Lsolve=lambda v:sla.spsolve_triangular(Lf,v,lower=True); LTsolve=lambda v:sla.spsolve_triangular(LTf,v,lower=False)
tset=T()-t0
eps=np.logspace(-4,2,neps)
tf=tl=0; out=[]; nit=0; t1=T()
for ep in eps:
    ta=T(); lus=[sla.splu(W+ep*I,permc_spec='MMD_AT_PLUS_A',diag_pivot_thresh=0.0,options=dict(SymmetricMode=True)) for W,_,_,I in S]; tb=T()
    cnt=[0]
    def mv(v):
        cnt[0]+=1; z=LTsolve(v); w=np.zeros(ng)
        for (W,AhT,Ah,I),lu in zip(S,lus): w+=Ah@lu.solve(AhT@z)
        return Lsolve(w)
    conv='ok'
    if meth=='dense':
        Y=np.zeros((ng,ng))
        for (W,AhT,Ah,I),lu in zip(S,lus):
            cols=np.unique(Ah.indices*0+np.repeat(np.arange(ng),np.diff(Ah.indptr)))
            R=np.ascontiguousarray(AhT[:,cols].toarray()); Z=lu.solve(R); Y[np.ix_(cols,cols)]+=Ah[cols]@Z; cnt[0]+=len(cols)
        if xd=='diagonal': Y*=s[:,None]; Y*=s[None,:]
        else: Y=dla.solve_triangular(Lf.toarray(),dla.solve_triangular(Lf.toarray(),Y,lower=True).T,lower=True)
        Y=0.5*(Y+Y.T); lam=dla.eigh(Y,eigvals_only=True,subset_by_index=[ng-1,ng-1],overwrite_a=True,check_finite=False)[0]
    else:
        op=sla.LinearOperator((ng,ng),matvec=mv,dtype=float)
        try: lam=sla.eigsh(op,k=1,which='LM',tol=tol,ncv=min(ng,60) if meth=='arpack60' else None,maxiter=500,return_eigenvectors=False,v0=np.random.default_rng(0).standard_normal(ng))[0]
        except sla.ArpackNoConvergence as ex: lam=float('nan'); conv='FAILED'
    tc=T(); tf+=tb-ta; tl+=tc-tb; nit+=cnt[0]; out.append((ep,lam,cnt[0],tb-ta,tc-tb)); fails=sum(1 for o in out if o[1]!=o[1])
    if not quiet: print('  eps=%.4e rho=%.12f matvecs=%d factor=%.3fs eig=%.3fs'%out[-1],flush=True)
    if T()-t1>maxsec: print('  STOPPED by time limit after %d eps'%len(out)); break
print('scipy '+meth+' N=%d nsd=%d contacts=%d interface_dofs=%d X %s setup=%.3fs eps=%d total=%.3fs (factor %.3fs, eigsh %.3fs, matvecs %d) tol=%g noconv=%d rho(first)=%.12f rho(last)=%.12f'%(N,nsd,nc,ng,xd,tset,len(out),T()-t1,tf,tl,nit,tol,fails,out[0][1],out[-1][1]))
