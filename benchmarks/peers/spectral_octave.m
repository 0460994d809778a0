% SPDX-License-Identifier: GPL-3.0-or-later
% Octave baseline: rho(B_eps) for a triangular lattice of N disks in nsd vertical strips (same problem as spectral_scipy.py)
% usage: octave-cli --no-gui -q spectral_octave.m N nsd [neps=20] [method dense|eigs] [max seconds]
args=argv(); N=str2double(args{1}); nsd=str2double(args{2}); neps=20; if numel(args)>2, neps=str2double(args{3}); end
meth='dense'; if numel(args)>3, meth=args{4}; end
maxsec=1e9; if numel(args)>4, maxsec=str2double(args{5}); end
t0=tic;
ncol=max(2,round(sqrt(2*N*sqrt(3)/2)));
k=(0:N-1)'; row=floor(k/ncol); col=mod(k,ncol); x=col+0.5*mod(row,2); y=row*sqrt(3)/2;
id=@(r,c) r*ncol+c+1;
% contacts: right, upper-left, upper-right
I=[];J=[];
ok=(col+1<ncol)&(k+1<N); I=[I;k(ok)+1]; J=[J;k(ok)+2];
for s=[0 1]
  c2=col-1+mod(row,2)+s; t=(row+1)*ncol+c2; ok=(c2>=0)&(c2<ncol)&(t<N); I=[I;k(ok)+1]; J=[J;t(ok)+1];
end
n=[x(J)-x(I), y(J)-y(I)]; n=n./sqrt(sum(n.^2,2)); nc=numel(I);
xm=0.5*(x(I)+x(J)); sd=min(floor((xm-min(x))/(max(x)-min(x)+1e-9)*nsd),nsd-1)+1;
inc=sparse([I;J],[sd;sd],1,N,nsd)>0; mult=full(sum(inc,2));
gl=cell(nsd,1); g=0;   % signed boolean gluing rows
for b=find(mult>1)'
  es=find(inc(b,:));
  for a=1:numel(es)-1, g++; gl{es(a)}(end+1,:)=[g b 1]; gl{es(a+1)}(end+1,:)=[g b -1]; end
end
ng=2*g; X=sparse(ng,ng); S=cell(nsd,1); loc=zeros(N,1);
for e=1:nsd
  c=find(sd==e); bod=unique([I(c);J(c)]); loc(bod)=1:numel(bod); nb=numel(bod); m=1./mult(bod); q=(1:numel(c))';
  li=loc(I(c)); lj=loc(J(c));
  H=sparse([2*li-1;2*li;2*lj-1;2*lj],[q;q;q;q],[-n(c,1);-n(c,2);n(c,1);n(c,2)],2*nb,numel(c));
  Mi=spdiags(kron(1./m,[1;1]),0,2*nb,2*nb); G=gl{e};
  A=sparse([2*G(:,1)-1;2*G(:,1)],[2*loc(G(:,2))-1;2*loc(G(:,2))],[G(:,3);G(:,3)],ng,2*nb);
  W=H'*Mi*H; Ah=A*Mi*H; X=X+A*Mi*A'; S{e}=struct('W',W,'Ah',Ah,'rows',unique([2*G(:,1)-1;2*G(:,1)]));
end
Lx=chol(X,'lower'); tset=toc(t0);
eps_=logspace(-4,2,neps); t1=tic; tf=0; te=0; out=[];
for ep=eps_
  ta=tic; F=cell(nsd,1);
  for e=1:nsd, [R,p,Q]=chol(S{e}.W+ep*speye(size(S{e}.W)),'vector'); F{e}=struct('R',R,'Q',Q); end
  tf+=toc(ta); tb=tic; fail=0;
  if strcmp(meth,'dense')
    Y=zeros(ng);
    for e=1:nsd
      r=S{e}.rows; B=full(S{e}.Ah(r,F{e}.Q))'; Z=F{e}.R'\B; Y(r,r)+=Z'*Z;
    end
    Y=Lx\(Lx\Y)'; Y=(Y+Y')/2; o.issym=true; o.tol=1e-8; o.p=min(ng,60); o.maxit=500;
    if ng<20000, lam=max(eig(Y)); else, [V,D,fl]=eigs(Y,1,'la',o); lam=D(1); fail=fl; end
  else
    function z=mv(v,S,F,Lx,nsd)
      w=Lx'\v; z=zeros(size(v));
      for e=1:nsd, a=S{e}.Ah'*w; b=zeros(size(a)); b(F{e}.Q)=F{e}.R\(F{e}.R'\a(F{e}.Q)); z+=S{e}.Ah*b; end
      z=Lx\z;
    end
    o.issym=true; o.isreal=true; o.tol=1e-8; o.p=min(ng,60); o.maxit=500; [V,D,fl]=eigs(@(v) mv(v,S,F,Lx,nsd),ng,1,'la',o); lam=D(1); fail=fl;
  end
  te+=toc(tb); out(end+1,:)=[ep lam fail];
  if toc(t1)>maxsec, printf('  STOPPED by time limit after %d eps\n',size(out,1)); break; end
end
printf('octave %s N=%d nsd=%d contacts=%d interface_dofs=%d setup=%.3fs eps=%d total=%.3fs (chol %.3fs, eig %.3fs) noconv=%d rho(first)=%.12f rho(last)=%.12f\n',meth,N,nsd,nc,ng,tset,size(out,1),toc(t1),tf,te,sum(out(:,3)!=0),out(1,2),out(end,2));
