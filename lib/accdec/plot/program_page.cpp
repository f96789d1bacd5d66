#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/plot/html.hpp>
#include <accdec/plot/program_page.hpp>

namespace accdec {
namespace {

constexpr std::int64_t page_points_max = 40'000;
constexpr std::array<double, 7> turns{0.0, 5.0, 20.0, 45.0, 75.0, 105.0, 180.0};

/// Follows a motion along its path: the block that a sample lies on, by the projection onto it.
class Follower {
 public:
  explicit Follower(const Toolpath& path) : path_(path), n_(path.dimensions()) {}

  /// Moves on to the block of a position.
  void follow(const double* x) {
    for (;; ++block_) {
      const bool last = block_ + 1 == path_.blocks();
      double along = 0.0, length2 = 0.0, from_next = 0.0;
      const double* p = path_.point(block_);
      for (std::size_t a = 0; a < n_; ++a) {
        const double u = p[n_ + a] - p[a];
        along += (x[a] - p[a]) * u;
        length2 += u * u;
        if (!last) from_next += (x[a] - p[n_ + a]) * (p[2 * n_ + a] - p[n_ + a]);
      }
      part_ = std::clamp(along / length2, 0.0, 1.0);
      // On this block until past its end or, where the corner is cut, on the way along the next.
      const bool leaving = part_ > 0.5 && from_next > 0.0;
      if (last || (along < length2 && !leaving)) return;
    }
  }
  std::size_t block() const { return block_; }
  /// The joint nearer to the sample: at the end of this block, or before it (-1: the start of the program).
  std::ptrdiff_t joint() const { return static_cast<std::ptrdiff_t>(block_) - (part_ < 0.5 ? 1 : 0); }
  double feed() const {
    double length2 = 0.0;
    const double* p = path_.point(block_);
    for (std::size_t a = 0; a < n_; ++a) length2 += (p[n_ + a] - p[a]) * (p[n_ + a] - p[a]);
    return std::sqrt(length2) / path_.duration[block_];
  }

 private:
  const Toolpath& path_;
  const std::size_t n_;
  std::size_t block_ = 0;
  double part_ = 0.0;
};

double turn_at(const Toolpath& path, std::size_t b) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(b);
  double dot = 0.0, in2 = 0.0, out2 = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    const double u = p[n + a] - p[a], w = p[2 * n + a] - p[n + a];
    dot += u * w;
    in2 += u * u;
    out2 += w * w;
  }
  return std::acos(std::clamp(dot / std::sqrt(in2 * out2), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

double norm(const double* v, std::size_t n) {
  double sum = 0.0;
  for (std::size_t a = 0; a < n; ++a) sum += v[a] * v[a];
  return std::sqrt(sum);
}

/// The limits of one machine, and how much of each a sample uses.
class Uses {
 public:
  Uses(const Machine& machine, double period) : period_(period) {
    for (const Axis& axis : machine.axes) axes_.push_back({&axis, AxisSampler(axis, period)});
  }
  /// Index in `axis_limits` of the limit most used by the next sample; -1 if none by 98 %.
  int next(const double* v) {
    int binding = -1;
    double most = 0.98;
    for (Followed& followed : axes_) {
      const AxisState state = followed.sampler.next(*v, (*v - followed.velocity) / period_);
      for (std::size_t i = 0; i < axis_limits.size(); ++i) {
        const double use = axis_limits[i].value(state) / (followed.axis->*axis_limits[i].bound);
        if (use > most) most = use, binding = static_cast<int>(i);
      }
      followed.velocity = *v++;
    }
    return binding;
  }

 private:
  struct Followed {
    const Axis* axis;
    AxisSampler sampler;
    double velocity = 0.0;  ///< m/s, of the last sample
  };
  double period_;
  std::vector<Followed> axes_;
};

/// The two axes of the largest extent.
std::array<std::size_t, 2> page_view_of(const Toolpath& path) {
  const std::size_t n = path.dimensions();
  std::vector<std::pair<double, std::size_t>> extent;
  for (std::size_t a = 0; a < n; ++a) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = 0; i <= path.blocks(); ++i) {
      low = std::min(low, path.point(i)[a]);
      high = std::max(high, path.point(i)[a]);
    }
    extent.emplace_back(low - high, a);
  }
  std::stable_sort(extent.begin(), extent.end());
  if (n == 1) return {0, 0};
  return {std::min(extent[0].second, extent[1].second), std::max(extent[0].second, extent[1].second)};
}

std::string arrays(const Toolpath& path, const Machine& machine, const PageMotion& motion, std::int64_t count) {
  const std::array<std::size_t, 2> view = page_view_of(path);
  const std::int64_t every = std::max<std::int64_t>(1, (count + page_points_max - 1) / page_points_max);
  Uses uses(machine, motion.sample_period);
  std::string t, x, y, v, l;
  int binding = -1;
  motion.samples([&](std::int64_t k, const double* at, const double* velocity) {
    binding = std::max(binding, uses.next(velocity));
    if (k % every != 0 && k + 1 != count) return;
    t += fmt::format("{:.6g},", static_cast<double>(k) * motion.sample_period);
    x += fmt::format("{:.4f},", at[view[0]] * 1e3);
    y += fmt::format("{:.4f},", path.dimensions() > 1 ? at[view[1]] * 1e3 : 0.0);
    v += fmt::format("{:.5g},", norm(velocity, path.dimensions()) * 1e3);
    l += fmt::format("{},", binding);
    binding = -1;
  });
  std::string names;
  for (const AxisLimit& limit : axis_limits) names += fmt::format("\"{}\",", to_string(limit.kind));
  return fmt::format("const D={{t:[{}],x:[{}],y:[{}],v:[{}],l:[{}],names:[{}],ax:[\"{}\",\"{}\"]}};\n", t, x, y, v, l,
                     names, path.axis_name(view[0]), path.axis_name(view[1]));
}

constexpr std::string_view script = R"JS(
const P=document.getElementById("path"),S=document.getElementById("speed"),info=document.getElementById("info");
const N=D.t.length,top_=Math.max(...[0,...D.v.filter(isFinite)]),lim=["#1f77b4","#d62728","#9467bd","#ff7f0e","#8c564b","#e377c2"];
const stops=[[68,1,84],[59,82,139],[33,145,140],[94,201,98],[253,231,37]];
function hue(q){q=Math.min(0.999,Math.max(0,q))*4;const i=Math.floor(q),f=q-i,a=stops[i],b=stops[i+1];
 return `rgb(${a.map((c,k)=>Math.round(c+f*(b[k]-c)))})`;}
let x0=Infinity,x1=-Infinity,y0=Infinity,y1=-Infinity;
for(let i=0;i<N;i++){x0=Math.min(x0,D.x[i]);x1=Math.max(x1,D.x[i]);y0=Math.min(y0,D.y[i]);y1=Math.max(y1,D.y[i]);}
let k,cx,cy,ta=0,tb=D.t[N-1],mark=-1;
function home(){k=0.95*Math.min(P.width/Math.max(1e-6,x1-x0),P.height/Math.max(1e-6,y1-y0));cx=(x0+x1)/2;cy=(y0+y1)/2;
 ta=0;tb=D.t[N-1];draw();}
const px=i=>P.width/2+(D.x[i]-cx)*k,py=i=>P.height/2-(D.y[i]-cy)*k,
 sx=i=>50+(D.t[i]-ta)/(tb-ta)*(S.width-60),sy=v=>S.height-25-v/top_*(S.height-40);
function draw(){
 let g=P.getContext("2d");g.clearRect(0,0,P.width,P.height);g.lineWidth=2;g.lineCap="round";
 for(let i=1;i<N;i++){const a=px(i-1),b=py(i-1),c=px(i),d=py(i);
  if(Math.max(a,c)<0||Math.min(a,c)>P.width||Math.max(b,d)<0||Math.min(b,d)>P.height)continue;
  g.strokeStyle=hue(D.v[i]/top_);g.beginPath();g.moveTo(a,b);g.lineTo(c,d);g.stroke();}
 if(mark>=0){g.fillStyle="#d00";g.beginPath();g.arc(px(mark),py(mark),5,0,7);g.fill();}
 const mm=Math.pow(10,Math.floor(Math.log10(150/k)));g.fillStyle=g.strokeStyle="#000";g.lineWidth=1;
 g.fillText(`${mm} mm`,12,P.height-18);g.beginPath();g.moveTo(12,P.height-12);g.lineTo(12+mm*k,P.height-12);g.stroke();
 for(let i=0;i<100;i++){g.fillStyle=hue(i/100);g.fillRect(P.width-130+i,12,1,10);}
 g.fillStyle="#000";g.fillText("0",P.width-132,34);g.fillText(`${top_.toPrecision(3)} mm/s`,P.width-70,34);
 g=S.getContext("2d");g.clearRect(0,0,S.width,S.height);
 for(let i=1;i<N;i++){if(D.t[i]<ta||D.t[i-1]>tb)continue;
  g.strokeStyle=D.l[i]<0?"#999":lim[D.l[i]];g.lineWidth=1.5;g.beginPath();g.moveTo(sx(i-1),sy(D.v[i-1]));g.lineTo(sx(i),sy(D.v[i]));g.stroke();}
 g.clearRect(0,0,49,S.height);g.fillStyle="#000";
 for(let q=0;q<=4;q++){g.fillText((top_*q/4).toPrecision(3),8,sy(top_*q/4)+4);g.fillText((ta+(tb-ta)*q/4).toPrecision(5)+" s",45+q*(S.width-95)/4,S.height-8);}
 if(mark>=0){g.strokeStyle="#d00";g.beginPath();g.moveTo(sx(mark),10);g.lineTo(sx(mark),S.height-25);g.stroke();}
 info.textContent=mark<0?"":`${D.t[mark]} s: ${D.ax[0]} ${D.x[mark]}, ${D.ax[1]} ${D.y[mark]} mm, ${D.v[mark]} mm/s, `+
  (D.l[mark]<0?"no limit binds":D.names[D.l[mark]]+" binds");}
const at=(e,c)=>{const r=c.getBoundingClientRect();return[(e.clientX-r.left)*c.width/r.width,(e.clientY-r.top)*c.height/r.height];};
P.onwheel=e=>{e.preventDefault();const[a,b]=at(e,P),f=Math.exp(-e.deltaY*0.0015),u=cx+(a-P.width/2)/k,w=cy-(b-P.height/2)/k;
 k*=f;cx=u-(a-P.width/2)/k;cy=w+(b-P.height/2)/k;draw();};
S.onwheel=e=>{e.preventDefault();const a=at(e,S)[0],f=Math.exp(e.deltaY*0.0015),u=ta+(a-50)/(S.width-60)*(tb-ta);
 ta=Math.max(0,u+(ta-u)*f);tb=Math.min(D.t[N-1],u+(tb-u)*f);draw();};
let drag=null;
P.onmousedown=e=>{drag=[...at(e,P),cx,cy];};window.onmouseup=()=>{drag=null;};
P.onmousemove=e=>{const[a,b]=at(e,P);if(drag){cx=drag[2]-(a-drag[0])/k;cy=drag[3]+(b-drag[1])/k;draw();return;}
 let best=225,m=-1;for(let i=0;i<N;i++){const q=(px(i)-a)**2+(py(i)-b)**2;if(q<best){best=q;m=i;}}mark=m;draw();};
S.onmousemove=e=>{const t=ta+(at(e,S)[0]-50)/(S.width-60)*(tb-ta);let lo=0,hi=N-1;
 while(hi-lo>1){const m=(lo+hi)>>1;if(D.t[m]<t)lo=m;else hi=m;}mark=hi;draw();};
P.ondblclick=S.ondblclick=home;
document.getElementById("legend").innerHTML=D.names.map((n,i)=>D.l.includes(i)?`<b style="color:${lim[i]}">&#9632;</b> ${n} `:"").join("")+
 '<b style="color:#999">&#9632;</b> no limit';
home();
)JS";

}  // namespace

std::vector<CornerLoss> time_lost(const Toolpath& path, const PageMotion& motion) {
  std::vector<CornerLoss> classes;
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) classes.push_back({turns[i], turns[i + 1], false, 0, 0.0});
  classes.push_back({0.0, 180.0, true, 0, 0.0});
  std::vector<std::uint8_t> of_joint(path.blocks(), 0);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    std::size_t i = classes.size() - 1;
    if (path.joint[b] != Joint::stop) {
      const double turn = turn_at(path, b);
      i = 0;
      while (i + 2 < turns.size() && turn > turns[i + 1]) ++i;
    }
    of_joint[b] = static_cast<std::uint8_t>(i);
    ++classes[i].count;
  }
  Follower follower(path);
  motion.samples([&](std::int64_t k, const double* x, const double* v) {
    if (k == 0) return;
    follower.follow(x);
    const double slower = 1.0 - norm(v, path.dimensions()) / follower.feed();
    const std::ptrdiff_t joint = follower.joint();
    const std::size_t i = joint < 0 ? classes.size() - 1 : of_joint[static_cast<std::size_t>(joint)];
    classes[i].time += slower * motion.sample_period;
  });
  return classes;
}

std::string program_page(const Toolpath& programmed, const Machine& machine, const PageMotion& motion) {
  std::int64_t count = 0;
  motion.samples([&](std::int64_t, const double*, const double*) { ++count; });
  std::vector<std::vector<std::string>> rows;
  for (const CornerLoss& loss : time_lost(programmed, motion)) {
    if (loss.count == 0) continue;
    rows.push_back(
        {loss.stop ? "stops, start and end" : fmt::format("{:g} to {:g} degrees", loss.turn_from, loss.turn_to),
         fmt::format("{}", loss.count), fmt::format("{:.4f}", loss.time),
         fmt::format("{:.3f}", 1e3 * loss.time / static_cast<double>(loss.count))});
  }
  std::string page = html_head(motion.title);
  page +=
      "<p>Wheel: zoom. Drag: move. Double click: everything. The path has the colour of its speed; the speed over time "
      "that of the limit that binds.</p>\n<canvas id=path width=1100 height=700 style=\"width:100%;border:1px solid "
      "#ccc\"></canvas>\n<p id=info>&nbsp;</p>\n<canvas id=speed width=1100 height=260 style=\"width:100%;border:1px "
      "solid #ccc\"></canvas>\n<p id=legend></p>\n<h2>Time lost against the programmed feed</h2>\n";
  page += html_table({{"turn", "joints", "lost, s", "lost by each, ms"}, rows});
  page += "<script>\n" + arrays(programmed, machine, motion, count) + std::string(script) + "</script>\n" + html_foot();
  return page;
}

}  // namespace accdec
