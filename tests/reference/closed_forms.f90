!> Tests. The closed form of each deck in input/, chosen by the deck's base name.
module closed_forms
   use quad_jet, only: qp, jet_t, time_jet
   use closed_forms_dyads, only: body_t
   use closed_forms_four_bars, only: four_bars
   use closed_forms_sliders, only: sliders
   use closed_forms_linkages, only: linkages
   use closed_forms_robots, only: robots
   use closed_forms_ratios, only: ratio_laws, by_drives
   use closed_forms_overconstrained, only: overconstrained
   use closed_forms_assemblies, only: platform_assemblies, platform
   use closed_forms_published, only: published
   use expected_tolerances, only: tolerant_links
   implicit none
   private
   public :: closed_form

contains

   !> The links of the mechanism `name` at the time `t`, in its set number `set`, or in that variant of its only set;
   !> none for an unknown name. The angles are on any branch: whoever asks brings them to the branch wanted.
   pure function closed_form(name, set, t) result(links)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t), allocatable :: links(:)
      type(jet_t) :: time

      time = time_jet(t)
      select case (name)
      case ('tolerances'); links = tolerant_links(1, t)
      case ('guide_tolerances'); links = tolerant_links(2, t)
      case ('landing_gear'); links = tolerant_links(3, t)
      case ('platform')
         ! Of its assemblies that with the angle nearest to 60 deg.
         associate (all => platform_assemblies())
            links = platform(all(:, minloc(abs(all(3, :) - 1.05_qp), dim=1)))
         end associate
      case default
         links = four_bars(name, set, time)
         if (size(links) == 0) links = sliders(name, set, time)
         if (size(links) == 0) links = linkages(name, set, time)
         if (size(links) == 0) links = robots(name, time)
         if (size(links) == 0) links = overconstrained(name, time)
         if (size(links) == 0) links = published(name, set, time)
         if (size(links) == 0) links = by_drives(name, ratio_laws(name, time))
      end select
   end function closed_form
end module closed_forms
